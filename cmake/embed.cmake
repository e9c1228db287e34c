# homolog_embed(TARGET NAME FILE): makes the bytes of FILE available to TARGET as
#   extern const unsigned char NAME[]; extern const std::size_t NAME_size;
# The bytes come in through the assembler, so a 1 MB font costs no compile time.
enable_language(ASM)
function(homolog_embed target name file)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/embed_${name}.S)
  file(CONFIGURE OUTPUT ${source} @ONLY CONTENT [[
.section .rodata
.global @name@
.global @name@_size
.balign 16
@name@:
.incbin "@file@"
@name@_end:
.byte 0
.balign 8
@name@_size:
.quad @name@_end - @name@
.section .note.GNU-stack,"",%progbits
]])
  set_source_files_properties(${source} PROPERTIES OBJECT_DEPENDS ${file})
  target_sources(${target} PRIVATE ${source})
endfunction()
