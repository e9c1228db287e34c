# homolog_arrows(FOLDER USED…): what a folder of the source tree may include: itself, and the USED, other folders or
# single headers. The build stops at any other, once a target depends on homolog_FOLDER_arrows. (One root holds all
# headers, so no compiler would notice; cmake/arrows.sh looks.)
function(homolog_arrows folder)
  string(REPLACE "/" "_" target homolog_${folder}_arrows)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.h ${PROJECT_SOURCE_DIR}/${folder}/*.cpp)
  set(checked ${PROJECT_BINARY_DIR}/arrows/${target})
  add_custom_command(OUTPUT ${checked}
    COMMAND ${PROJECT_SOURCE_DIR}/cmake/arrows.sh ${PROJECT_SOURCE_DIR} ${folder} ${ARGN}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_BINARY_DIR}/arrows
    COMMAND ${CMAKE_COMMAND} -E touch ${checked}
    DEPENDS ${files} ${PROJECT_SOURCE_DIR}/cmake/arrows.sh
    COMMENT "What ${folder} includes")
  add_custom_target(${target} DEPENDS ${checked})
endfunction()

# homolog_part(FOLDER USES folder… SOURCES file… LIBRARIES library… SYSTEM_INCLUDES folder…): a folder of the source tree
# as a target of its own, named homolog_ and the folder (core/mesh is homolog_core_mesh). USES are the other folders, and
# single headers, that it may include, all of them [homolog_arrows]. The global property homolog_core_parts lists the
# targets of core, what is used first.
function(homolog_part folder)
  cmake_parse_arguments(PART "" "" "USES;SOURCES;LIBRARIES;SYSTEM_INCLUDES" ${ARGN})
  string(REPLACE "/" "_" target homolog_${folder})
  list(TRANSFORM PART_SOURCES PREPEND ${PROJECT_SOURCE_DIR}/${folder}/)

  homolog_arrows(${folder} ${PART_USES})
  add_library(${target} STATIC ${PART_SOURCES})
  string(REGEX MATCH "^[^/]*" top ${folder})
  set_property(GLOBAL APPEND PROPERTY homolog_${top}_parts ${target})
  add_dependencies(${target} ${target}_arrows)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include/homolog>)
  target_include_directories(${target} SYSTEM PRIVATE ${PART_SYSTEM_INCLUDES})
  target_link_libraries(${target} PUBLIC ${homolog_part_basis} PRIVATE $<BUILD_INTERFACE:homolog_options> ${PART_LIBRARIES})
  list(FILTER PART_USES EXCLUDE REGEX "\\.h$")
  foreach(used ${PART_USES})
    if(used STREQUAL render)
      set(used scene)  # its values; who draws names homolog_render among the libraries
    endif()
    string(REPLACE "/" "_" used homolog_${used})
    target_link_libraries(${target} PUBLIC ${used})
  endforeach()
endfunction()
