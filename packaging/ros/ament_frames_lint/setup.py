from setuptools import setup

NAME = 'ament_frames_lint'

setup(
    name=NAME,
    version='0.1.0',
    packages=[NAME],
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + NAME]),
        ('share/' + NAME, ['package.xml']),
    ],
    install_requires=['setuptools'],
    zip_safe=True,
    description='Checks coordinate frames with frames-lint, and writes an xUnit file.',
    license='MIT OR Apache-2.0',
    entry_points={
        'console_scripts': ['ament_frames_lint = ament_frames_lint.main:main'],
        'pytest11': ['ament_frames_lint = ament_frames_lint.pytest_marker'],
    },
)
