#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/base/result.h"

namespace homolog {

/// An NRRD header in two parts: the text that the library may see, and what is read here. It must not see where the
/// voxels are: it hands a "data file" that holds a '%' to sprintf, opens pipes, and takes "-" for the standard input.
/// And it refuses units that are not quoted as it does.
struct NrrdHeader {
  std::string fields;               ///< every line but "data file", the names below it, and units
  std::uintmax_t voxels_begin = 0;  ///< behind the header, where the voxels follow in the same file

  bool detached = false;                     ///< the voxels are in files of their own
  std::vector<std::filesystem::path> files;  ///< these, in order, beside the header
  int file_dimension = 0;                    ///< axes that each file holds; 0: all but the last, or all in one file

  std::vector<std::string> space_units, units;  ///< units of the space and of the array's axes; none: not said
  std::vector<std::pair<std::string, std::string>> segment_pairs;  ///< KEY:=VALUE of 3D Slicer's segments
  bool is_segmentation = false;                                    ///< 3D Slicer's: a list of values is one of layers
  bool is_diffusion = false;                                       ///< a list of values is one of gradients
};

/// Reads a file's header up to the empty line that ends it [NRRD format, "data file", the three ways of naming files].
/// A format may hold one `%d`, with a width of at most two digits, padded with blanks or zeros (`slice%03d.raw`). Fails
/// on every other '%', on a range that is none or of more than a million files, and where no header is found.
Result<NrrdHeader> read_nrrd_header(const std::filesystem::path& path);

}  // namespace homolog
