#include <metaImage.h>

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <mutex>
#include <optional>

#include "core/volume/readers.h"

// MetaImage through MetaIO, the library behind ITK's reader: it parses the header; the voxels are read here, which adds
// progress, cancellation and a check that all are there (MetaIO fills the rest of a short file with zeros).
namespace homolog {
namespace fs = std::filesystem;

namespace {

/// MetaIO reports to std::cerr and offers no other way.
class SilencedCerr {
 public:
  SilencedCerr() : lock_(mutex()), before_(std::cerr.rdbuf(nullptr)) {}
  ~SilencedCerr() {
    std::cerr.rdbuf(before_);
    std::cerr.clear();
  }
  SilencedCerr(const SilencedCerr&) = delete;
  SilencedCerr& operator=(const SilencedCerr&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex only;
    return only;
  }
  std::lock_guard<std::mutex> lock_;
  std::streambuf* before_;
};

std::optional<StoredType> stored_type(MET_ValueEnumType type) {
  switch (type) {
    case MET_CHAR:
      return StoredType::Int8;
    case MET_UCHAR:
      return StoredType::Uint8;
    case MET_SHORT:
      return StoredType::Int16;
    case MET_USHORT:
      return StoredType::Uint16;
    case MET_INT:
    case MET_LONG:
      return StoredType::Int32;  // MetaIO's long has four bytes everywhere
    case MET_UINT:
    case MET_ULONG:
      return StoredType::Uint32;
    case MET_LONG_LONG:
      return StoredType::Int64;
    case MET_ULONG_LONG:
      return StoredType::Uint64;
    case MET_FLOAT:
      return StoredType::Float32;
    case MET_DOUBLE:
      return StoredType::Float64;
    default:
      return {};
  }
}

/// MetaIO keeps ten dimensions and writes beyond them where a header claims more.
bool claims_sane_dimensions(const std::string& head) {
  const auto key = head.find("NDims");
  if (key == std::string::npos) return false;
  const auto value = head.find_first_not_of(" \t=", key + 5);
  if (value == std::string::npos) return false;
  const int dimensions = std::atoi(head.c_str() + value);
  return dimensions >= 1 && dimensions <= 10;
}

struct Header {
  MetaImage image;
  std::uintmax_t local_offset = 0;  ///< of voxels that follow in the same file
};

Result<void> parse_header(const fs::path& path, Header& header) {
  const auto head = read_head(path, 8192);
  if (!head) return fail(head.error());
  if (!claims_sane_dimensions(*head))
    return fail(path.string(),
                "is not a MetaImage file, or its header is damaged; check what it is and export it again");
  std::ifstream stream(path, std::ios::binary);
  const SilencedCerr silence;
  if (!header.image.ReadStream(0, &stream, false))
    return fail(path.string(), "has a damaged MetaImage header; export it again");
  const std::streamoff behind = stream.tellg();
  header.local_offset = behind >= 0 ? static_cast<std::uintmax_t>(behind) : fs::file_size(path);  // nothing follows
  return {};
}

double mm_per_unit(const MetaImage& image) {
  const std::string units = image.DistanceUnitsName();
  return units == "um" ? 1e-3 : units == "cm" ? 10 : 1;
}

Result<VolumeGeometry> geometry_of(const MetaImage& image, const fs::path& path) {
  std::array<std::int64_t, 3> dims{1, 1, 1};
  Mat3 steps = Mat3::Identity();
  Vec3 origin = Vec3::Zero();
  const int n = std::min(image.NDims(), 3);
  const double scale = mm_per_unit(image);
  for (int a = 0; a < n; ++a) {
    dims[static_cast<std::size_t>(a)] = image.DimSize(a);
    origin[a] = scale * image.Offset(a);
    for (int r = 0; r < n; ++r) steps(r, a) = scale * image.ElementSpacing(a) * image.TransformMatrix(a, r);
  }
  return make_geometry(path, dims, steps, origin);
}

Result<VoxelRun> find_run(const Header& header, StoredType type, double voxels, const fs::path& path) {
  const MetaImage& image = header.image;
  const std::string data_file = image.ElementDataFileName();
  if (!image.BinaryData() || data_file.starts_with("LIST") || data_file.find('%') != std::string::npos)
    return fail(path.string(), "keeps its voxels as text or in several files; save it as one binary .mha");
  VoxelRun run;
  run.type = type;
  run.other_byte_order = image.BinaryDataByteOrderMSB() != native_big_endian();
  run.block.compression = image.CompressedData() ? Compression::Deflate : Compression::None;
  if (data_file == "LOCAL" || data_file == "Local" || data_file == "local") {
    run.block.file = path;
    run.block.offset = header.local_offset;
    return run;
  }
  run.block.file = path.parent_path() / data_file;
  std::error_code absent;
  const auto size = static_cast<double>(fs::file_size(run.block.file, absent));
  if (absent)
    return fail(path.string(), "has no voxels: its file " + data_file + " is missing; put it into the same folder");
  if (image.HeaderSize() > 0) run.block.offset = static_cast<std::uintmax_t>(image.HeaderSize());
  if (image.HeaderSize() == -1)  // the voxels end with the file
    run.block.offset =
        static_cast<std::uintmax_t>(std::max(0.0, size - voxels * static_cast<double>(bytes_per_voxel(type))));
  return run;
}

}  // namespace

Result<VolumeRead> read_metaimage(const fs::path& path, Progress* progress) {
  Header header;
  if (const auto parsed = parse_header(path, header); !parsed) return fail(parsed.error());
  const MetaImage& image = header.image;
  double extra = 1;
  for (int d = 4; d < image.NDims(); ++d) extra *= image.DimSize(d);
  if (image.ElementNumberOfChannels() != 1 || extra != 1)
    return fail(path.string(),
                "holds several values for each voxel (vectors, colours or five dimensions); export one "
                "scalar volume or a series of frames");
  const auto type = stored_type(image.ElementType());
  if (!type) return fail(path.string(), "holds voxels that are no numbers; export it as a scalar volume");

  VolumeRead result;
  Volume& volume = result.volume;
  auto geometry = geometry_of(image, path);
  if (!geometry) return fail(geometry.error());
  volume.geometry = *geometry;
  if (image.NDims() > 3) {
    volume.frames = image.DimSize(3);
    if (volume.frames < 1) return fail(path.string(), "claims no frames; its header is damaged, export it again");
    if (volume.frames > 1) volume.frame_seconds = std::max(0.0, image.ElementSpacing(3));
  }
  double voxels = volume.frames;
  for (const int n : volume.geometry.dims) voxels *= n;
  const auto run = find_run(header, *type, voxels, path);
  if (!run) return fail(run.error());
  auto stored = read_run(*run, volume.geometry, volume.frames, false, progress);
  if (!stored) return fail(stored.error());
  if (auto kept = keep_voxels(std::move(*stored), {}, path.string(), volume, result.warnings); !kept)
    return fail(kept.error());
  return result;
}

}  // namespace homolog
