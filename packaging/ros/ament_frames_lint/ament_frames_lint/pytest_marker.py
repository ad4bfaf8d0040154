"""The markers of the linter's test, as ament's own linters have them."""


def pytest_configure(config):
    config.addinivalue_line('markers', 'frames_lint: marks tests checking coordinate frames with frames-lint')
