#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>

#include "core/base/files/file_record.h"
#include "core/base/files/files.h"
#include "core/volume/formats/formats.h"
#include "core/volume/labels/read_labels.h"
#include "core/volume/labels/slicer_segments.h"
#include "core/volume/nrrd_grid.h"
#include "core/volume/nrrd_header.h"
#include "core/volume/readers.h"
#include "core/volume/text_voxels.h"
#include "core/volume/write_voxels.h"

// NRRD. NrrdIO, the library behind ITK's reader, parses the fields of the header, given as text; it opens no file. The
// voxels are read here, which adds bzip2, progress and cancellation.
namespace homolog {
namespace fs = std::filesystem;

namespace {

struct NrrdDeleter {
  void operator()(Nrrd* nrrd) const { nrrdNuke(nrrd); }
};
struct IoStateDeleter {
  void operator()(NrrdIoState* state) const {
    state->headerStringRead = nullptr;  // not the library's
    nrrdIoStateNix(state);
  }
};
using NrrdPointer = std::unique_ptr<Nrrd, NrrdDeleter>;
using IoStatePointer = std::unique_ptr<NrrdIoState, IoStateDeleter>;

/// NrrdIO's own words, its last line only: the lines before name its functions.
std::string library_error() {
  char* text = biffGetDone(NRRD);
  std::string message = text ? text : "";
  std::free(text);
  while (!message.empty() && message.back() == '\n') message.pop_back();
  if (const auto line = message.rfind('\n'); line != std::string::npos) message.erase(0, line + 1);
  if (const auto colon = message.find(": "); message.starts_with('[') && colon != std::string::npos)
    message.erase(0, colon + 2);
  return message;
}

tl::unexpected<Error> refused(const fs::path& path, const std::string& why) {
  return fail(path.string(),
              "cannot be read as NRRD" + (why.empty() ? "" : " (" + why + ")") + "; check the file or export it again");
}

/// Parses the fields. NrrdIO keeps its messages in one place for all threads, so that one parses at a time.
Result<void> parse_fields(const fs::path& path, const std::string& fields, Nrrd& nrrd, NrrdIoState& state) {
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  state.skipData = 1;
  if (nrrdStringRead(&nrrd, fields.c_str(), &state) != 0) return refused(path, library_error());
  for (const int field : {nrrdField_type, nrrdField_dimension, nrrdField_sizes, nrrdField_encoding})
    if (!state.seen[field]) return refused(path, std::string("it lacks the field ") + airEnumStr(nrrdField, field));
  if (state.dataFNFormat || state.dataFNArr->len > 0) return refused(path, "its data file is given twice");
  return {};
}

std::optional<Scalar> stored_nrrd_type(int type) {
  switch (type) {
    case nrrdTypeChar:
      return Scalar::int8;
    case nrrdTypeUChar:
      return Scalar::uint8;
    case nrrdTypeShort:
      return Scalar::int16;
    case nrrdTypeUShort:
      return Scalar::uint16;
    case nrrdTypeInt:
      return Scalar::int32;
    case nrrdTypeUInt:
      return Scalar::uint32;
    case nrrdTypeLLong:
      return Scalar::int64;
    case nrrdTypeULLong:
      return Scalar::uint64;
    case nrrdTypeFloat:
      return Scalar::float32;
    case nrrdTypeDouble:
      return Scalar::float64;
    default:
      return {};
  }
}

/// Frames that are stored fastest (3D Slicer's sequences) moved to the back.
struct FramesToBack {
  std::size_t frames;
  StoredVoxels operator()(auto& values) const {
    std::decay_t<decltype(values)> moved(values.size());
    const std::size_t voxels = values.size() / frames;
    for (std::size_t v = 0; v < voxels; ++v)
      for (std::size_t f = 0; f < frames; ++f) moved[f * voxels + v] = values[v * frames + f];
    return moved;
  }
};

/// The voxels of the array, in floating point, since what a header claims may overflow any integer.
double voxels_of(const Nrrd& nrrd, unsigned axes) {
  double voxels = 1;
  for (unsigned a = 0; a < axes; ++a) voxels *= static_cast<double>(nrrd.axis[a].size);
  return voxels;
}

/// The files that the voxels lie in, checked against how many there should be.
Result<std::vector<fs::path>> voxel_files(const NrrdHeader& header, const Nrrd& nrrd, const fs::path& path) {
  if (!header.detached) return std::vector{path};
  const auto files = static_cast<double>(header.files.size());
  const auto given = static_cast<unsigned>(header.file_dimension);
  const unsigned axes = given > 0 ? given : nrrd.dim - 1;
  const bool slabs = given == nrrd.dim && std::fmod(static_cast<double>(nrrd.axis[nrrd.dim - 1].size), files) == 0;
  if (header.files.size() == 1 || slabs ||
      (axes < nrrd.dim && voxels_of(nrrd, axes) * files == voxels_of(nrrd, nrrd.dim)))
    return header.files;
  return fail(path.string(), "names " + std::to_string(header.files.size()) +
                                 " files for its voxels, but its sizes need another number of files; export it again");
}

/// The end of the lines to be passed over.
Result<std::uintmax_t> skip_lines(const fs::path& file, std::uintmax_t begin, unsigned lines) {
  if (lines == 0) return begin;
  if (const auto size = size_of_file(file); !size) return fail(size.error());
  std::ifstream in(file, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(begin));
  for (; lines > 0; --lines)
    if (!in.ignore(std::numeric_limits<std::streamsize>::max(), '\n') || in.eof())
      return fail(file.string(), "is shorter than the lines to skip that its header gives; export it again");
  return static_cast<std::uintmax_t>(in.tellg());
}

/// The runs of bytes that the voxels lie in.
Result<VoxelRun> find_nrrd_run(const NrrdHeader& header, const Nrrd& nrrd, const NrrdIoState& state, Scalar type,
                               const fs::path& path) {
  const auto files = voxel_files(header, nrrd, path);
  if (!files) return fail(files.error());
  VoxelRun run;
  run.type = type;
  run.other_byte_order = size_of(type) > 1 && (state.endian == airEndianBig) != native_big_endian();
  for (const fs::path& file : *files) {
    const auto begin = skip_lines(file, header.detached ? 0 : header.voxels_begin, state.lineSkip);
    if (!begin) return fail(begin.error());
    ByteBlock block{.file = file, .offset = *begin, .ends_file = true};
    if (state.encoding == nrrdEncodingGzip) block.compression = Compression::Deflate;
    if (state.encoding == nrrdEncodingBzip2) block.compression = Compression::Bzip2;
    if (state.byteSkip >= 0) {
      block.skip = static_cast<std::uintmax_t>(state.byteSkip);
    } else {  // the voxels end with the file
      const auto size = size_of_file(file);
      if (!size) return fail(size.error());
      const double bytes = voxels_of(nrrd, nrrd.dim) * static_cast<double>(size_of(type));
      const double before = static_cast<double>(*size) - bytes / static_cast<double>(files->size());
      if (state.byteSkip != -1 || state.encoding != nrrdEncodingRaw || before < static_cast<double>(*begin))
        return fail(path.string(), "gives an impossible place for its voxels (byte skip: " +
                                       std::to_string(state.byteSkip) + "); export it again");
      block.offset = static_cast<std::uintmax_t>(before);
    }
    run.blocks.push_back(std::move(block));
  }
  return run;
}

/// Tells what a list of values is besides frames.
void name_list(const fs::path& path, const NrrdHeader& header, VolumeRead& read) {
  const auto layers = header.is_segmentation ? static_cast<std::size_t>(read.volume.frames) : 1;
  read.segmentation = slicer_segments(path, header.segment_pairs, layers, read.warnings);
  read.segments_are_own = !read.segmentation.segments.empty();
  if (read.volume.frames < 2) return;
  if (header.is_segmentation) return take_layers(path, read);
  if (header.is_diffusion)
    read.warnings.push_back(path.string() +
                            ": holds an image for each gradient of a diffusion scan; they are shown as "
                            "frames, though they do not follow one another in time");
}

Result<VolumeRead> read_nrrd(const fs::path& path, const VolumeReadOptions& options) {
  const auto header = read_nrrd_header(path);
  if (!header) return fail(header.error());
  const NrrdPointer nrrd(nrrdNew());
  const IoStatePointer state(nrrdIoStateNew());
  if (const auto parsed = parse_fields(path, header->fields, *nrrd, *state); !parsed) return fail(parsed.error());
  const auto type = stored_nrrd_type(nrrd->type);
  if (!type) return fail(path.string(), "holds voxels that are no numbers; export it as a scalar volume");
  const auto axes = find_axes(*nrrd, path);
  if (!axes) return fail(axes.error());

  VolumeRead result;
  Volume& volume = result.volume;
  auto geometry = grid_of(*nrrd, *header, *axes, path, result.warnings);
  if (!geometry) return fail(geometry.error());
  volume.geometry = *geometry;
  const std::size_t frames = axes->frames ? nrrd->axis[*axes->frames].size : 1;
  if (frames > std::numeric_limits<int>::max()) return fail(path.string(), "claims more frames than there can be");
  volume.frames = static_cast<int>(frames);
  if (axes->frames) volume.frame_seconds = seconds_between_frames(*nrrd, *header, *axes->frames);
  if (options.without_voxels && !header->is_segmentation) return result;

  const auto run = find_nrrd_run(*header, *nrrd, *state, *type, path);
  if (!run) return fail(run.error());
  const bool frames_first = axes->frames && *axes->frames == 0 && nrrd->dim > 1;
  const bool numbers = state->encoding == nrrdEncodingAscii, hex = state->encoding == nrrdEncodingHex;
  auto stored = numbers || hex
                    ? read_text_voxels(*run, hex ? VoxelText::Hex : VoxelText::Numbers, volume.geometry, volume.frames)
                    : read_run(*run, volume.geometry, volume.frames, frames_first, options.progress);
  if (!stored) return fail(stored.error());
  if (frames_first) stored = std::visit(FramesToBack{frames}, *stored);
  if (auto kept = keep_voxels(std::move(*stored), {}, path.string(), volume, result.warnings); !kept)
    return fail(kept.error());
  name_list(path, *header, result);
  return result;
}

Result<void> write_nrrd(const Volume& volume, const fs::path& path, const std::string& record, Progress* progress) {
  constexpr std::array types{"uint8", "int16", "uint16", "float"};
  const VolumeGeometry& g = volume.geometry;
  const bool cine = volume.frames > 1;
  auto header = exact_text();
  const auto vector = [&header](const Vec3& v) { header << " (" << v[0] << ',' << v[1] << ',' << v[2] << ')'; };
  header << "NRRD0004\ntype: " << types[volume.data.index()] << "\ndimension: " << (cine ? 4 : 3)
         << "\nspace: left-posterior-superior\nsizes: " << g.dims[0] << ' ' << g.dims[1] << ' ' << g.dims[2];
  if (cine) header << ' ' << volume.frames;
  header << "\nspace directions:";
  for (int a = 0; a < 3; ++a) vector(g.direction.col(a) * g.spacing_mm[a]);
  if (cine) header << " none";
  header << "\nkinds: domain domain domain" << (cine ? " list" : "");
  if (cine && volume.frame_seconds > 0)
    header << "\nspacings: nan nan nan " << volume.frame_seconds << "\nunits: \"\" \"\" \"\" \"s\"";
  header << "\nendian: " << (native_big_endian() ? "big" : "little") << "\nencoding: gzip\nspace origin:";
  vector(g.origin_mm);
  header << record_of_nrrd(record) << "\n\n";
  return write_whole_file(path, [&](std::ostream& out) -> Result<void> {
    out << header.str();
    return write_compressed(out, {}, volume.data, progress);
  });
}

}  // namespace

const VolumeFormat formats::nrrd{
    .name = "NRRD",
    .endings = {".nrrd", ".nhdr"},
    .written = {".nrrd"},
    .note = "also compressed, also with frames, also with the voxels in files of their own",
    .read = read_nrrd,
    .write = write_nrrd,
    .keeps_record = true};

}  // namespace homolog
