#pragma once

#include <string_view>

namespace homolog {

/// Writes all bytes to a descriptor of the system, where it stands. Returns 0, or the errno of what failed.
int write_all(int descriptor, std::string_view bytes);

}  // namespace homolog
