#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/numbers/geometry.h"
#include "core/base/result.h"

namespace homolog::formats {

/// The lines of a VTP file in place of its faces.
struct VtpLines {
  Points points;                                 ///< LPS mm
  std::vector<std::vector<std::int64_t>> lines;  ///< each as indices of points
  std::vector<std::string> warnings;
};

/// Takes the bytes of a whole file. Errors name no file: damaged, or a line through a point that is not there.
Result<VtpLines> vtp_lines(std::string_view bytes);

}  // namespace homolog::formats
