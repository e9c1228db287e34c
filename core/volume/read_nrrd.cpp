#include <NrrdIO.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <optional>

#include "core/volume/readers.h"

// NRRD through NrrdIO, the library behind ITK's reader: it parses the header; voxels that lie in one run of bytes are
// read here, which adds bzip2, progress and cancellation. Other layouts (text, several data files) are read by it.
namespace homolog {
namespace fs = std::filesystem;

namespace {

struct NrrdDeleter {
  void operator()(Nrrd* nrrd) const { nrrdNuke(nrrd); }
};
struct IoStateDeleter {
  void operator()(NrrdIoState* state) const {
    if (state->dataFile) std::fclose(state->dataFile);
    state->dataFile = nullptr;
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

tl::unexpected<Error> refused(const fs::path& path) {
  const std::string why = library_error();
  return fail(path.string(),
              "cannot be read as NRRD" + (why.empty() ? "" : " (" + why + ")") + "; check the file or export it again");
}

std::optional<StoredType> stored_type(int type) {
  switch (type) {
    case nrrdTypeChar:
      return StoredType::Int8;
    case nrrdTypeUChar:
      return StoredType::Uint8;
    case nrrdTypeShort:
      return StoredType::Int16;
    case nrrdTypeUShort:
      return StoredType::Uint16;
    case nrrdTypeInt:
      return StoredType::Int32;
    case nrrdTypeUInt:
      return StoredType::Uint32;
    case nrrdTypeLLong:
      return StoredType::Int64;
    case nrrdTypeULLong:
      return StoredType::Uint64;
    case nrrdTypeFloat:
      return StoredType::Float32;
    case nrrdTypeDouble:
      return StoredType::Float64;
    default:
      return {};
  }
}

/// Which axes of the array are the patient's, and which one, if any, holds frames.
struct Axes {
  std::vector<unsigned> space;
  std::optional<unsigned> frames;
};

Result<Axes> find_axes(const Nrrd& nrrd, const fs::path& path) {
  Axes axes;
  for (unsigned a = 0; a < nrrd.dim; ++a) {
    const NrrdAxisInfo& axis = nrrd.axis[a];
    const bool placed = nrrd.spaceDim > 0 && std::isfinite(axis.spaceDirection[0]);
    const bool domain = axis.kind == nrrdKindUnknown || axis.kind == nrrdKindDomain || axis.kind == nrrdKindSpace;
    if (placed || (nrrd.spaceDim == 0 && domain && axes.space.size() < 3)) {
      axes.space.push_back(a);
    } else if (axis.size == 1) {
      continue;
    } else if (!axes.frames && (domain || axis.kind == nrrdKindTime || axis.kind == nrrdKindList)) {
      axes.frames = a;
    } else {
      return fail(path.string(),
                  "holds several values for each voxel (vectors, colours or five dimensions); export one "
                  "scalar volume or a series of frames");
    }
  }
  if (axes.space.size() < 2 || axes.space.size() > 3)
    return fail(path.string(), "is no image of two or three dimensions; export it as a volume");
  if (axes.frames && *axes.frames != 0 && *axes.frames != nrrd.dim - 1)
    return fail(path.string(), "keeps its frames between two axes of space; export it with the frames first or last");
  return axes;
}

/// LPS = sign · the file's space [NRRD format, §"space"]; spaces that do not name the patient's sides stay as they are.
Vec3 lps_signs(int space, const fs::path& path, std::vector<std::string>& warnings) {
  switch (space) {
    case nrrdSpaceRightAnteriorSuperior:
      return {-1, -1, 1};
    case nrrdSpaceLeftAnteriorSuperior:
      return {1, -1, 1};
    case nrrdSpaceLeftPosteriorSuperior:
      return {1, 1, 1};
    default:
      warnings.push_back(path.string() +
                         ": does not name the patient's sides; its axes are taken to run to the left, "
                         "back and head");
      return {1, 1, 1};
  }
}

Result<VolumeGeometry> geometry_of(const Nrrd& nrrd, const Axes& axes, const fs::path& path,
                                   std::vector<std::string>& warnings) {
  std::array<std::int64_t, 3> dims{1, 1, 1};
  Mat3 steps = Mat3::Identity();
  Vec3 origin = Vec3::Zero();
  for (std::size_t a = 0; a < axes.space.size(); ++a) {
    const NrrdAxisInfo& axis = nrrd.axis[axes.space[a]];
    const auto column = static_cast<Eigen::Index>(a);
    dims[a] = static_cast<std::int64_t>(std::min<std::size_t>(axis.size, std::numeric_limits<std::int64_t>::max()));
    for (unsigned s = 0; s < nrrd.spaceDim; ++s) {
      steps(s, column) = axis.spaceDirection[s];
      if (std::isfinite(nrrd.spaceOrigin[s])) origin[s] = nrrd.spaceOrigin[s];
    }
    if (nrrd.spaceDim == 0) {
      if (std::isfinite(axis.spacing) && axis.spacing != 0) steps(column, column) = std::abs(axis.spacing);
      if (std::isfinite(axis.min)) origin[column] = axis.min;
    }
  }
  if (nrrd.spaceDim > 3) return fail(path.string(), "is placed in four dimensions; export it in a space of three");
  const Vec3 signs = lps_signs(nrrd.space, path, warnings);
  return make_geometry(path, dims, signs.asDiagonal() * steps, signs.asDiagonal() * origin);
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

/// The run of bytes that the voxels lie in; nothing where they are text or in several files.
std::optional<VoxelRun> find_run(const Nrrd& nrrd, const NrrdIoState& state, StoredType type, const fs::path& path) {
  Compression compression = Compression::None;
  if (state.encoding == nrrdEncodingGzip)
    compression = Compression::Deflate;
  else if (state.encoding == nrrdEncodingBzip2)
    compression = Compression::Bzip2;
  else if (state.encoding != nrrdEncodingRaw)
    return {};
  if (!state.dataFile || state.dataFNFormat || state.dataFNArr->len > 1) return {};
  if (compression != Compression::None && state.byteSkip < 0) return {};
  VoxelRun run;
  run.type = type;
  run.block.file = state.dataFNArr->len == 1 ? path.parent_path() / state.dataFN[0] : path;
  run.block.compression = compression;
  // NrrdIO has passed over lines, and over bytes where they are not within the compressed stream.
  run.block.offset = static_cast<std::uintmax_t>(std::max(0L, std::ftell(state.dataFile)));
  if (compression != Compression::None) run.block.skip = static_cast<std::uintmax_t>(state.byteSkip);
  run.other_byte_order = nrrdElementSize(&nrrd) > 1 && (state.endian == airEndianBig) != native_big_endian();
  return run;
}

Result<StoredVoxels> load_by_library(const fs::path& path, const NrrdIoState& state, StoredType type,
                                     const VolumeGeometry& geometry, double frames) {
  double voxels = frames;
  for (const int n : geometry.dims) voxels *= n;
  if (state.encoding == nrrdEncodingAscii || state.encoding == nrrdEncodingHex) {
    const ByteBlock text{.file = state.dataFNArr->len == 1 ? path.parent_path() / state.dataFN[0] : path};
    // Every value takes a character and a separator, the last one perhaps only the character.
    if (const auto credible = check_claim(text, 2 * voxels - 1, 0); !credible) return fail(credible.error());
  }
  // NrrdIO's own copy comes on top.
  const double twice = 2 * bytes_while_reading(type, voxels, true);
  if (const auto enough = check_memory(path, twice); !enough) return fail(enough.error());
  const NrrdPointer nrrd(nrrdNew());
  if (nrrdLoad(nrrd.get(), path.c_str(), nullptr) != 0) return refused(path);
  StoredVoxels stored = make_stored_voxels(type, nrrdElementNumber(nrrd.get()));
  const auto bytes = bytes_of(stored);
  std::memcpy(bytes.data(), nrrd->data, bytes.size());
  return stored;
}

double frame_seconds_of(const NrrdAxisInfo& axis) {
  if (!std::isfinite(axis.spacing) || axis.spacing <= 0) return 0;
  const std::string units = axis.units ? axis.units : "";
  return units == "ms" || units == "msec" ? axis.spacing / 1000 : axis.spacing;
}

}  // namespace

Result<VolumeRead> read_nrrd(const fs::path& path, Progress* progress) {
  const NrrdPointer nrrd(nrrdNew());
  const IoStatePointer state(nrrdIoStateNew());
  state->skipData = 1;
  state->keepNrrdDataFileOpen = 1;
  if (nrrdLoad(nrrd.get(), path.c_str(), state.get()) != 0) return refused(path);
  const auto type = stored_type(nrrd->type);
  if (!type) return fail(path.string(), "holds voxels that are no numbers; export it as a scalar volume");
  const auto axes = find_axes(*nrrd, path);
  if (!axes) return fail(axes.error());

  VolumeRead result;
  Volume& volume = result.volume;
  auto geometry = geometry_of(*nrrd, *axes, path, result.warnings);
  if (!geometry) return fail(geometry.error());
  volume.geometry = *geometry;
  const std::size_t frames = axes->frames ? nrrd->axis[*axes->frames].size : 1;
  if (frames > std::numeric_limits<int>::max()) return fail(path.string(), "claims more frames than there can be");
  volume.frames = static_cast<int>(frames);
  if (axes->frames) volume.frame_seconds = frame_seconds_of(nrrd->axis[*axes->frames]);

  const auto run = find_run(*nrrd, *state, *type, path);
  auto stored = run ? read_run(*run, volume.geometry, volume.frames, false, progress)
                    : load_by_library(path, *state, *type, volume.geometry, volume.frames);
  if (!stored) return fail(stored.error());
  if (axes->frames && *axes->frames == 0 && nrrd->dim > 1) stored = std::visit(FramesToBack{frames}, *stored);
  if (auto kept = keep_voxels(std::move(*stored), {}, path.string(), volume, result.warnings); !kept)
    return fail(kept.error());
  return result;
}

}  // namespace homolog
