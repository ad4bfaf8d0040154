# Files that state transforms, or configure frames-lint.
file(GLOB_RECURSE _frames_lint_files FOLLOW_SYMLINKS
  "*.urdf" "*.xacro" "*.sdf" "frames-lint.yaml")
if(_frames_lint_files)
  message(STATUS "Added test 'frames_lint' to check coordinate frames")
  ament_frames_lint()
endif()
