#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string_view>

#include "core/base/files/files.h"
#include "core/base/text/text.h"
#include "core/volume/formats/formats.h"
#include "core/volume/length_units.h"
#include "core/volume/readers.h"
#include "core/volume/write_voxels.h"

// MetaImage: a few lines "Key = Value", then the voxels [itk.org/Wiki/MetaIO/Documentation]. Read here rather than by
// ITK's MetaIO, which writes beyond its buffers on damaged headers and leaves the rest of a short file at zero.
namespace homolog {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t longest_text = std::size_t{1} << 16;

struct Header {
  std::map<std::string, std::string, std::less<>> fields;
  std::uintmax_t local_offset = 0;  ///< the place of voxels that follow in the same file

  /// The value under the first of several names that is there; empty without any.
  std::string text(std::initializer_list<std::string_view> names) const {
    for (const std::string_view name : names)
      if (const auto found = fields.find(name); found != fields.end()) return found->second;
    return {};
  }
  bool is_true(std::initializer_list<std::string_view> names) const {
    const std::string value = text(names);
    return !value.empty() && (value[0] == 'T' || value[0] == 't' || value[0] == '1');
  }
  /// The numbers of a value; none of them where it holds what is no number.
  std::vector<double> numbers(std::initializer_list<std::string_view> names) const {
    std::vector<double> result;
    const std::string value = text(names);
    constexpr const char* blanks = " \t";
    for (std::size_t begin = 0; (begin = value.find_first_not_of(blanks, begin)) != std::string::npos;) {
      const auto end = std::min(value.find_first_of(blanks, begin), value.size());
      std::string_view word = std::string_view(value).substr(begin, end - begin);
      begin = end;
      if (word.ends_with(',')) word.remove_suffix(1);  // "1, 5" is two numbers, "1,5" is none
      if (word.empty()) continue;
      if (word.starts_with('+')) word.remove_prefix(1);
      const auto number = as_number<double>(word);
      if (!number || !std::isfinite(*number)) return {};
      result.push_back(*number);
    }
    return result;
  }
  /// NaN where what is said is not one number.
  double number(std::initializer_list<std::string_view> names, double otherwise) const {
    if (text(names).empty()) return otherwise;
    const auto all = numbers(names);
    return all.size() == 1 ? all.front() : std::numeric_limits<double>::quiet_NaN();
  }
};

/// ElementDataFile is the last line of every header.
std::optional<Header> parse_header(std::string_view head) {
  Header header;
  for (std::size_t begin = 0; begin < head.size();) {
    const auto end = head.find('\n', begin);
    if (end == std::string_view::npos && head.size() >= longest_text) return {};
    const std::string_view line = head.substr(begin, end == std::string_view::npos ? end : end - begin);
    begin = end == std::string_view::npos ? head.size() : end + 1;
    const auto equals = line.find('=');
    if (equals == std::string_view::npos) {
      if (trimmed(line).empty()) continue;
      return {};
    }
    const std::string key(trimmed(line.substr(0, equals)));
    if (!header.fields.emplace(key, trimmed(line.substr(equals + 1))).second && key != "Comment") return {};
    if (key == "ElementDataFile") {
      header.local_offset = begin;
      return header;
    }
  }
  return {};
}

std::optional<Scalar> stored_type(const std::string& name) {
  static const std::map<std::string, Scalar, std::less<>> types{
      {"MET_CHAR", Scalar::int8},       {"MET_UCHAR", Scalar::uint8},       {"MET_SHORT", Scalar::int16},
      {"MET_USHORT", Scalar::uint16},   {"MET_INT", Scalar::int32},         {"MET_UINT", Scalar::uint32},
      {"MET_LONG", Scalar::int32},      {"MET_ULONG", Scalar::uint32},  // four bytes everywhere
      {"MET_LONG_LONG", Scalar::int64}, {"MET_ULONG_LONG", Scalar::uint64}, {"MET_FLOAT", Scalar::float32},
      {"MET_DOUBLE", Scalar::float64}};
  const auto found = types.find(name);
  if (found == types.end()) return {};
  return found->second;
}

tl::unexpected<Error> damaged_header(const fs::path& path) {
  return fail(path.string(), "is not a MetaImage file, or its header is damaged; check what it is and export it again");
}

std::int64_t as_integer(double number) {
  constexpr double most = 1e15;
  return static_cast<std::int64_t>(std::clamp(number, -most, most));
}

/// The header's numbers for two to four dimensions; frames are the fourth.
struct Layout {
  VolumeGeometry geometry;
  int frames = 1;
  double frame_seconds = 0;
};

Result<Layout> layout_of(const Header& header, const fs::path& path, std::vector<std::string>& warnings) {
  const std::vector<double> sizes = header.numbers({"DimSize"});
  const auto is_whole = [](double size) { return size == std::floor(size); };
  const double axes = header.number({"NDims"}, 0);
  if (!(axes >= 1 && axes <= 100 && is_whole(axes))) return damaged_header(path);
  const auto n = static_cast<std::size_t>(axes);
  // What is not said has a default; what is said must be whole.
  const auto check = [&](std::initializer_list<std::string_view> names, std::size_t count) -> Result<void> {
    const std::size_t said = header.numbers(names).size();
    const bool flat =
        n == 2 && count == 2 && said == 3 && *names.begin() != "DimSize";  // of an image, also the third axis is said
    if (header.text(names).empty() || said == count || flat) return {};
    return fail(path.string(), std::string(*names.begin()) + " is \"" + excerpt(header.text(names)) + "\", and not " +
                                   std::to_string(count) + " numbers with blanks between them; export it again");
  };
  const std::initializer_list<std::string_view> spacings{"ElementSpacing", "ElementSize"},
      origins{"Offset", "Position", "Origin"}, matrices{"TransformMatrix", "Rotation", "Orientation"};
  if (header.text({"DimSize"}).empty() || header.numbers(matrices).size() > n * n) return damaged_header(path);
  for (const auto& checked : {check({"DimSize"}, n), check(spacings, n), check(origins, n), check(matrices, n * n)})
    if (!checked) return fail(checked.error());
  if (sizes.empty() || !std::ranges::all_of(sizes, is_whole)) return damaged_header(path);
  for (std::size_t d = 4; d < n; ++d)
    if (sizes[d] != 1)
      return fail(path.string(), "has more than four dimensions; export one volume or series of frames");
  std::vector<double> spacing = header.numbers(spacings), origin = header.numbers(origins);
  const std::vector<double> matrix = header.numbers(matrices);
  spacing.resize(std::max<std::size_t>(n, 4), 1);
  origin.resize(std::max<std::size_t>(n, 4), 0);
  for (std::size_t a = 0; a < n; ++a)
    if (!(spacing[a] > 0) && (a < 3 || spacing[a] < 0))
      return fail(path.string(), "says that a voxel is 0 mm large or less (ElementSpacing); export it again");
  if (header.text(spacings).empty())
    warnings.push_back(path.string() + ": does not say how large a voxel is; 1 mm is assumed");
  const bool directed = !matrix.empty();
  const double scale = mm_or_warn(path, header.text({"DistanceUnits"}), warnings);
  std::array<std::int64_t, 3> dims{1, 1, 1};
  Mat3 steps = Mat3::Identity();
  Vec3 origin_mm = Vec3::Zero();
  for (std::size_t a = 0; a < std::min<std::size_t>(n, 3); ++a) {
    const auto column = static_cast<Eigen::Index>(a);
    dims[a] = as_integer(sizes[a]);
    origin_mm[column] = scale * origin[a];
    for (std::size_t r = 0; r < std::min<std::size_t>(n, 3); ++r)  // an axis's direction after the other
      steps(static_cast<Eigen::Index>(r), column) = scale * spacing[a] *
                                                    (directed ? matrix[a * n + r]
                                                     : r == a ? 1
                                                              : 0);
  }
  auto geometry = make_geometry(path, dims, steps, origin_mm);
  if (!geometry) return fail(geometry.error());
  Layout shape{*geometry, 1, 0};
  if (n > 3) {
    if (!(sizes[3] >= 1 && sizes[3] <= 1e6)) return damaged_header(path);
    shape.frames = static_cast<int>(sizes[3]);
    if (shape.frames > 1) shape.frame_seconds = std::max(0.0, spacing[3]);
  }
  return shape;
}

Result<VoxelRun> find_run(const Header& header, Scalar type, double bytes, const fs::path& path) {
  const std::string data_file = header.text({"ElementDataFile"});
  const std::string binary = header.text({"BinaryData"});
  if ((!binary.empty() && !header.is_true({"BinaryData"})) || data_file.starts_with("LIST") ||
      data_file.find('%') != std::string::npos)
    return fail(path.string(), "keeps its voxels as text or in several files; save it as one binary .mha");
  VoxelRun run;
  run.type = type;
  run.other_byte_order = header.is_true({"BinaryDataByteOrderMSB", "ElementByteOrderMSB"}) != native_big_endian();
  const bool local = data_file == "LOCAL" || data_file == "Local" || data_file == "local";
  ByteBlock block{.file = local ? path : path.parent_path() / data_file,
                  .offset = local ? header.local_offset : 0,
                  .ends_file = true};
  if (header.is_true({"CompressedData"})) block.compression = Compression::Deflate;
  std::error_code ignored;
  if (!local && !fs::exists(fs::symlink_status(block.file, ignored)))
    return fail(path.string(),
                "has no voxels: its file " + excerpt(data_file) + " is missing; put it into the same folder");
  const auto size = size_of_file(block.file);
  if (!size) return fail(size.error());
  const std::string skipped_text = header.text({"HeaderSize"});
  const double file_bytes = static_cast<double>(*size), skipped = header.number({"HeaderSize"}, 0);
  if (skipped == -1 && block.compression == Compression::None)  // the voxels end with the file, behind the header
    block.offset = std::max(block.offset, static_cast<std::uintmax_t>(std::max(0.0, file_bytes - bytes)));
  else if (skipped >= static_cast<double>(block.offset) && skipped > 0 && skipped <= file_bytes &&
           skipped == std::floor(skipped))
    block.offset = static_cast<std::uintmax_t>(skipped);
  else if (skipped != 0)
    return fail(path.string(),
                "gives an impossible place for its voxels (HeaderSize = " + skipped_text + "); export it again");
  run.blocks.push_back(std::move(block));
  return run;
}

/// Intensity = slope · stored + offset, where the header says so. Nothing where it does not say it in numbers.
std::optional<Rescale> intensity_of(const Header& header) {
  const std::initializer_list<std::string_view> slope{"ElementToIntensityFunctionSlope"},
      offset{"ElementToIntensityFunctionOffset"};
  const auto number = [&](const auto& names, double otherwise) -> std::optional<double> {
    if (header.text(names).empty()) return otherwise;
    const auto numbers = header.numbers(names);
    if (numbers.size() != 1) return {};
    return numbers.front();
  };
  const auto a = number(slope, 1), b = number(offset, 0);
  if (!a || !b || *a == 0) return {};
  return Rescale{*a, *b};
}

Result<VolumeRead> read_metaimage(const fs::path& path, const VolumeReadOptions& options) {
  const auto head = read_head(path, longest_text);
  if (!head) return fail(head.error());
  const auto header = parse_header(*head);
  if (!header) return damaged_header(path);
  if (header->number({"ElementNumberOfChannels"}, 1) != 1)
    return fail(path.string(), "holds several values for each voxel (vectors or colours); export one scalar volume");
  const auto type = stored_type(header->text({"ElementType"}));
  if (!type) return fail(path.string(), "holds voxels that are no plain numbers; export it as a scalar volume");
  const auto rescale = intensity_of(*header);
  if (!rescale)
    return fail(path.string(),
                "rescales its voxels by what is no number, or by 0 (ElementToIntensityFunction); export "
                "it again");
  VolumeRead result;
  const auto shape = layout_of(*header, path, result.warnings);
  if (!shape) return fail(shape.error());
  result.volume.geometry = shape->geometry;
  result.volume.frames = shape->frames;
  result.volume.frame_seconds = shape->frame_seconds;
  if (options.without_voxels) return result;
  double bytes = static_cast<double>(size_of(*type)) * shape->frames;
  for (const int size : shape->geometry.dims) bytes *= size;
  const auto run = find_run(*header, *type, bytes, path);
  if (!run) return fail(run.error());
  auto stored = read_run(*run, shape->geometry, shape->frames, !rescale->identity(), options.progress);
  if (!stored) return fail(stored.error());
  if (auto kept = keep_voxels(std::move(*stored), *rescale, path.string(), result.volume, result.warnings); !kept)
    return fail(kept.error());
  return result;
}

Result<void> write_metaimage(const Volume& volume, const fs::path& path, const std::string& /*record*/,
                             Progress* progress) {
  constexpr std::array types{"MET_UCHAR", "MET_SHORT", "MET_USHORT", "MET_FLOAT"};
  const VolumeGeometry& g = volume.geometry;
  const int n = volume.frames > 1 ? 4 : 3;
  auto header = exact_text();
  header << "ObjectType = Image\nNDims = " << n
         << "\nBinaryData = True\nBinaryDataByteOrderMSB = " << (native_big_endian() ? "True" : "False")
         << "\nCompressedData = False\nTransformMatrix =";
  for (int axis = 0; axis < n; ++axis)  // an axis's direction after the other
    for (int r = 0; r < n; ++r) header << ' ' << (axis < 3 && r < 3 ? g.direction(r, axis) : axis == r ? 1.0 : 0.0);
  header << "\nOffset = " << g.origin_mm[0] << ' ' << g.origin_mm[1] << ' ' << g.origin_mm[2] << (n == 4 ? " 0" : "");
  header << "\nElementSpacing = " << g.spacing_mm[0] << ' ' << g.spacing_mm[1] << ' ' << g.spacing_mm[2];
  if (n == 4) header << ' ' << (volume.frame_seconds > 0 ? volume.frame_seconds : 1);
  header << "\nDimSize = " << g.dims[0] << ' ' << g.dims[1] << ' ' << g.dims[2];
  if (n == 4) header << ' ' << volume.frames;
  header << "\nElementType = " << types[volume.data.index()] << "\nElementDataFile = LOCAL\n";
  return write_whole_file(path, [&](std::ostream& out) -> Result<void> {
    out << header.str();
    return write_plain(out, volume.data, progress);
  });
}

}  // namespace

const VolumeFormat formats::metaimage{.name = "MetaImage",
                                      .endings = {".mha", ".mhd"},
                                      .written = {".mha"},
                                      .read = read_metaimage,
                                      .write = write_metaimage};

}  // namespace homolog
