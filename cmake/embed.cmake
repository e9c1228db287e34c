# homolog_embed(TARGET NAME FILE): makes the bytes of FILE available to TARGET as
#   extern const unsigned char homolog_NAME[]; extern const std::size_t homolog_NAME_size;
# (in C's namespace, which programs share with all of their libraries: hence the prefix)
# The bytes come in through the assembler, so a 1 MB font costs no compile time.
enable_language(ASM)
function(homolog_embed target name file)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/embed_${name}.S)
  file(CONFIGURE OUTPUT ${source} @ONLY CONTENT [[
.section .rodata
.global homolog_@name@
.global homolog_@name@_size
.balign 16
homolog_@name@:
.incbin "@file@"
homolog_@name@_end:
.byte 0
.balign 8
homolog_@name@_size:
.quad homolog_@name@_end - homolog_@name@
.section .note.GNU-stack,"",%progbits
]])
  set_source_files_properties(${source} PROPERTIES OBJECT_DEPENDS ${file})
  target_sources(${target} PRIVATE ${source})
endfunction()
