# The report of a run: a library, its tests, and a look at the page in a real browser.
add_library(compliant_ur5_report STATIC arm_picture.cpp report.cpp)
target_link_libraries(compliant_ur5_report PUBLIC skinctl_program examples_plot)

if(SKINCTL_BUILD_TESTS)
  enable_testing()
  set(tests report_test)
  if(NOT SKINCTL_SANITIZERS AND NOT SKINCTL_GATE)  # a browser that looks at the same page shows the sanitizers nothing new
    list(APPEND tests report_in_browser)
    skinctl_runs_once(tests/report_in_browser.cpp)
  endif()
  foreach(name IN LISTS tests)
    add_executable(compliant_ur5_${name} tests/${name}.cpp)
    target_link_libraries(compliant_ur5_${name} PRIVATE compliant_ur5_report doctest::doctest)
    add_test(NAME examples/compliant_ur5/${name} COMMAND compliant_ur5_${name})
    set_tests_properties(examples/compliant_ur5/${name} PROPERTIES LABELS examples TIMEOUT 300)
  endforeach()
  target_link_libraries(compliant_ur5_report_test PRIVATE examples_test_main)
  if(TEST examples/compliant_ur5/report_in_browser)  # skipped, and ctest says so, where there is no Chromium
    set_tests_properties(examples/compliant_ur5/report_in_browser PROPERTIES SKIP_RETURN_CODE 77)
  endif()
endif()
