#pragma once

#include <cstddef>
#include <string>

/// Inter and Fork Awesome, as they are embedded [app/CMakeLists.txt].
extern "C" {
extern const unsigned char homolog_font_inter_regular[];
extern const std::size_t homolog_font_inter_regular_size;
extern const unsigned char homolog_font_inter_semibold[];
extern const std::size_t homolog_font_inter_semibold_size;
extern const unsigned char homolog_font_fork_awesome[];
extern const std::size_t homolog_font_fork_awesome_size;
}

namespace homolog {

/// The bytes of a font that has the letters of East Asia, where the system has one: of Debian's fonts-noto-cjk, which
/// has Korean too, else of fonts-droid-fallback; or of the same files in the user's own fonts. Empty where there is
/// none.
std::string east_asian_font();

}  // namespace homolog
