#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace homolog {

/// An NRRD header in two parts: the text that the library may see, and where the voxels are. The library must not see
/// the latter: it hands a "data file" that holds a '%' to sprintf, opens pipes, and takes "-" for the standard input.
struct NrrdHeader {
  std::string fields;               ///< every line but "data file" and the names below it
  std::uintmax_t voxels_begin = 0;  ///< behind the header, where the voxels follow in the same file

  bool detached = false;                     ///< the voxels are in files of their own
  std::vector<std::filesystem::path> files;  ///< these, in order, beside the header
  int file_dimension = 0;                    ///< axes that each file holds; 0: all but the last, or all in one file
};

/// Reads a file's header up to the empty line that ends it [NRRD format, "data file", the three ways of naming files].
/// Of a format one `%d` is taken, with a width of at most two digits, padded with blanks or zeros (`slice%03d.raw`).
/// Fails on every other '%', on a range that is none or of more than a million files, and where no header is found.
Result<NrrdHeader> read_nrrd_header(const std::filesystem::path& path);

}  // namespace homolog
