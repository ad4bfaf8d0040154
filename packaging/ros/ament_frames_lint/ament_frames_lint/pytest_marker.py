"""The markers of the linter's test, as in ament's own linters."""


def pytest_configure(config):
    config.addinivalue_line('markers', 'frames_lint: marks tests checking coordinate frames with frames-lint')
