# What `cmake --install` installs: the program, scripts and Python package, and the projection as a library for others,
# taut::projection, with its headers under taut/. It needs neither contact nor HDF5.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# Of these rooms the library takes some files alone: others of them need rooms that it goes without.
set_target_properties(taut_state taut_forces taut_filters PROPERTIES UNITY_BUILD OFF)
add_library(taut_projection STATIC)
foreach(room partition state linear forces constraints newton filters)
  target_sources(taut_projection PRIVATE $<TARGET_OBJECTS:taut_${room}>)
endforeach()
set_target_properties(taut_projection PROPERTIES LINKER_LANGUAGE CXX EXPORT_NAME projection)
target_link_libraries(taut_projection PUBLIC taut_common PRIVATE PkgConfig::PETSC ${METIS_LIBRARY} ${PTSCOTCH_LIBRARIES})
add_library(taut::projection ALIAS taut_projection)
add_dependencies(taut taut_projection) # so that who built the program can install

set_target_properties(taut_common PROPERTIES EXPORT_NAME common)
install(TARGETS taut RUNTIME)
install(TARGETS taut_projection taut_common EXPORT tautTargets ARCHIVE)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/taut)
install(EXPORT tautTargets NAMESPACE taut:: DESTINATION ${package})
configure_package_config_file(src/tautConfig.cmake.in ${PROJECT_BINARY_DIR}/tautConfig.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/tautConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/tautConfig.cmake ${PROJECT_BINARY_DIR}/tautConfigVersion.cmake DESTINATION ${package})

# The headers that a user names, and all that these include. There "src/filters/project.hpp" is
# <taut/filters/project.hpp>, and "partition/grid.hpp" <taut/partition/grid.hpp>.
function(install_headers root to)
  set(todo ${ARGN})
  set(done)
  while(todo)
    list(POP_FRONT todo header)
    if(header IN_LIST done)
      continue()
    endif()
    list(APPEND done ${header})
    file(READ ${root}/${header} text)
    string(REGEX MATCHALL "#include \"[^\"]+" included "${text}")
    list(TRANSFORM included REPLACE "#include \"" "")
    list(APPEND todo ${included})
    string(REGEX REPLACE "#include \"(src/)?([^\"]+)\"" "#include <taut/\\2>" text "${text}")
    string(REGEX REPLACE "^src/" "" header ${header})
    file(CONFIGURE OUTPUT ${to}/${header} CONTENT "${text}" @ONLY)
  endwhile()
endfunction()
install_headers(${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/headers src/filters/project.hpp src/linear/session.hpp
  partition/grid.hpp partition/distributed_mesh.hpp)
install(DIRECTORY ${PROJECT_BINARY_DIR}/headers/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/taut)

# The scripts that serve runs, with their Python package, which finds the program beside it.
set(scripts ${CMAKE_INSTALL_DATADIR}/taut/scripts)
install(PROGRAMS scripts/plot scripts/render scripts/with-screen scripts/slurm.sh DESTINATION ${scripts})
install(FILES scripts/render.py scripts/debian_python.py scripts/packages.sh scripts/pyproject.toml scripts/setup.cfg
  DESTINATION ${scripts})
install(DIRECTORY scripts/taut scripts/rendering DESTINATION ${scripts} PATTERN __pycache__ EXCLUDE)
