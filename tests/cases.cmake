# The cases, run as users run them, and what the program says to bad input.
find_program(TAUT_PYTHON python3 HINTS /usr/bin) # Debian's, for which the packages are

# Runs scripts/check-case at each number of ranks.
function(taut_case name)
  cmake_parse_arguments(arg "" "TIMEOUT" "RANKS" ${ARGN})
  list(JOIN TAUT_MPIEXEC_FLAGS " " flags)
  foreach(ranks ${arg_RANKS})
    add_test(NAME case_${name}_np${ranks}
      COMMAND ${PROJECT_SOURCE_DIR}/scripts/check-case ${name} --ranks ${ranks} --program $<TARGET_FILE:taut>
              --launch "${TAUT_MPIEXEC} ${flags}")
    set_tests_properties(case_${name}_np${ranks} PROPERTIES TIMEOUT ${arg_TIMEOUT} PROCESSORS ${ranks} LABELS "np${ranks};case")
  endforeach()
endfunction()

taut_case(two-pins RANKS 1 2 4 TIMEOUT 300)
taut_case(triangles RANKS 1 2 4 TIMEOUT 300)
taut_case(drape RANKS 1 2 3 4 8 TIMEOUT 300)
taut_case(chain RANKS 1 2 4 TIMEOUT 300)
taut_case(flag RANKS 1 2 4 TIMEOUT 300)
taut_case(obj RANKS 1 2 4 TIMEOUT 300)
taut_case(curtain RANKS 1 2 4 TIMEOUT 300)

taut_case(sphere RANKS 1 2 4 TIMEOUT 300)
taut_case(table RANKS 1 2 TIMEOUT 300)
taut_case(pile RANKS 1 4 TIMEOUT 300)
taut_case(moving-body RANKS 1 2 TIMEOUT 300)
taut_case(body-sequence RANKS 1 2 4 TIMEOUT 300)
taut_case(spin RANKS 1 2 TIMEOUT 300)
taut_case(twist RANKS 1 4 TIMEOUT 300)
taut_case(layers RANKS 1 4 TIMEOUT 300)
taut_case(skirt RANKS 1 4 TIMEOUT 300)
taut_case(capstan RANKS 1 2 TIMEOUT 300)
taut_case(incline RANKS 1 2 4 TIMEOUT 300)

# One rank needs no launcher; with mpirun -n 1 the whole test took five times as long.
set(bad_input ${TAUT_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/test_bad_input.py)
add_test(NAME test_bad_input_np1 COMMAND ${bad_input} $<TARGET_FILE:taut>)
add_test(NAME test_bad_input_np3
  COMMAND ${bad_input} ${TAUT_MPIEXEC} ${TAUT_MPIEXEC_FLAGS} ${MPIEXEC_NUMPROC_FLAG} 3 $<TARGET_FILE:taut>)
foreach(ranks 1 3)
  set_tests_properties(test_bad_input_np${ranks} PROPERTIES TIMEOUT 300 RUN_SERIAL ON LABELS np${ranks})
endforeach()
