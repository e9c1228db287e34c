# What a program that builds on Homolog needs: headers in include/homolog, static libraries, and targets for
# find_package(homolog COMPONENTS core render pictures). docs/library.md is about them. The packages of the program leave
# this component out.
get_property(core_parts GLOBAL PROPERTY homolog_core_parts)
set(config lib/cmake/homolog)
set_target_properties(homolog_core PROPERTIES EXPORT_NAME core)
set_target_properties(homolog_render PROPERTIES EXPORT_NAME render)

install(TARGETS homolog_core ${core_parts} EXPORT homolog_core ARCHIVE DESTINATION lib/homolog COMPONENT development)
install(EXPORT homolog_core NAMESPACE homolog:: DESTINATION ${config} FILE homolog_core.cmake COMPONENT development)
install(TARGETS homolog_scene homolog_render EXPORT homolog_render ARCHIVE DESTINATION lib/homolog COMPONENT development)
install(EXPORT homolog_render NAMESPACE homolog:: DESTINATION ${config} FILE homolog_render.cmake COMPONENT development)
install(TARGETS homolog_pictures LIBRARY DESTINATION lib/homolog COMPONENT development)
foreach(folder core render)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder} DESTINATION include/homolog COMPONENT development
    FILES_MATCHING PATTERN *.h)
endforeach()

include(CMakePackageConfigHelpers)
configure_package_config_file(homologConfig.cmake.in ${PROJECT_BINARY_DIR}/homologConfig.cmake
  INSTALL_DESTINATION ${config} NO_CHECK_REQUIRED_COMPONENTS_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/homologConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/homologConfig.cmake ${PROJECT_BINARY_DIR}/homologConfigVersion.cmake
  DESTINATION ${config} COMPONENT development)
