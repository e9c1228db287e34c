#pragma once

#include <cstddef>
#include <string_view>

/// The texts of the files in shaders/, embedded at build time (render/CMakeLists.txt): shaders/line.vert is
/// homolog::shaders::line_vert().
#define HOMOLOG_SHADER(name)                                                                     \
  extern "C" const unsigned char homolog_shader_##name[];                                        \
  extern "C" const std::size_t homolog_shader_##name##_size;                                     \
  inline std::string_view name() {                                                               \
    return {reinterpret_cast<const char*>(homolog_shader_##name), homolog_shader_##name##_size}; \
  }

namespace homolog::shaders {

HOMOLOG_SHADER(faint_frag)
HOMOLOG_SHADER(glyph_vert)
HOMOLOG_SHADER(glyph_frag)
HOMOLOG_SHADER(layer_vert)
HOMOLOG_SHADER(layer_frag)
HOMOLOG_SHADER(light_glsl)
HOMOLOG_SHADER(line_vert)
HOMOLOG_SHADER(line_frag)
HOMOLOG_SHADER(mesh_vert)
HOMOLOG_SHADER(mesh_frag)
HOMOLOG_SHADER(slice_vert)
HOMOLOG_SHADER(slice_frag)

}  // namespace homolog::shaders

#undef HOMOLOG_SHADER
