#
# Add a test that checks the coordinate frames of this package with frames-lint.
#
# :param TESTNAME: the name of the test, default: "frames_lint"
# :type TESTNAME: string
# :param CONFIG: the configuration, default: the nearest frames-lint.yaml
# :type CONFIG: string
# :param PROFILE: the profile of rules, default: that of the configuration
# :type PROFILE: string
# :param ARGN: files and folders to check together, default: the package
# :type ARGN: list of strings
#
# @public
#
function(ament_frames_lint)
  cmake_parse_arguments(ARG "" "TESTNAME;CONFIG;PROFILE" "" ${ARGN})
  if(NOT ARG_TESTNAME)
    set(ARG_TESTNAME "frames_lint")
  endif()

  find_program(ament_frames_lint_BIN NAMES "ament_frames_lint")
  if(NOT ament_frames_lint_BIN)
    message(FATAL_ERROR
      "ament_frames_lint() could not find program 'ament_frames_lint'")
  endif()

  set(result_file
    "${AMENT_TEST_RESULTS_DIR}/${PROJECT_NAME}/${ARG_TESTNAME}.xunit.xml")
  set(cmd "${ament_frames_lint_BIN}" "--xunit-file" "${result_file}")
  if(ARG_CONFIG)
    list(APPEND cmd "--config" "${ARG_CONFIG}")
  endif()
  if(ARG_PROFILE)
    list(APPEND cmd "--profile" "${ARG_PROFILE}")
  endif()
  list(APPEND cmd ${ARG_UNPARSED_ARGUMENTS})

  file(MAKE_DIRECTORY "${CMAKE_BINARY_DIR}/ament_frames_lint")
  ament_add_test(
    "${ARG_TESTNAME}"
    COMMAND ${cmd}
    OUTPUT_FILE "${CMAKE_BINARY_DIR}/ament_frames_lint/${ARG_TESTNAME}.txt"
    RESULT_FILE "${result_file}"
    WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}"
  )
  set_tests_properties(
    "${ARG_TESTNAME}"
    PROPERTIES
    LABELS "frames_lint;linter"
  )
endfunction()
