#include "core/volume/dicom/dicom_segments.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <string>

#include "core/base/processes/memory.h"
#include "core/base/text/text.h"
#include "core/volume/dicom/dicom_pixels.h"
#include "core/volume/dicom/dicom_segment_frames.h"
#include "core/volume/dicom/resample_slices.h"
#include "core/volume/stored_voxels.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

/// A file and what is known of it while its voxels are put in place.
struct SegmentationFile {
  const DicomHeader& header;
  const SegmentFrames& frames;
  FrameLattice lattice;
  bool on_series = false;  ///< the lattice is that of the series which was segmented
  Progress* progress = nullptr;

  std::string name() const { return header.path.string(); }
  std::size_t pixels() const {
    return static_cast<std::size_t>(header.rows) * static_cast<std::size_t>(header.columns);
  }
  /// The begin of a frame's voxels in a layer.
  std::size_t begin(std::size_t frame) const { return static_cast<std::size_t>(lattice.slices[frame]) * pixels(); }
  Result<void> room_for(double layers, double bytes) const {
    return check_memory(header.path, layers * bytes * static_cast<double>(lattice.geometry.voxels()));
  }
  /// Reports; errors: cancelled.
  Result<void> go_on(std::size_t done, std::size_t all) const {
    if (!progress) return {};
    if (progress->cancelled()) return fail(name(), "was not read: cancelled");
    progress->report(static_cast<double>(done) / static_cast<double>(std::max<std::size_t>(all, 1)));
    return {};
  }
};

/// The pixels of all frames: single bits behind one another, or whole values.
struct FramePixels {
  std::vector<std::byte> bits;
  bool frames_begin_bytes = false;  ///< each frame of bits begins with a byte of its own
  StoredVoxels values;

  /// Calls `see(pixel)` for every pixel of a frame that is set.
  template <class See>
  void for_each_set(std::size_t frame, std::size_t pixels, const See& see) const {
    if (bits.empty()) {
      std::visit(
          [&](const auto& all) {
            for (std::size_t p = 0; p < pixels; ++p)
              if (all[frame * pixels + p] != 0) see(p);
          },
          values);
      return;
    }
    const std::size_t begin = frames_begin_bytes ? frame * ((pixels + 7) / 8) * 8 : frame * pixels;
    for (std::size_t bit = begin; bit < begin + pixels;) {
      const auto byte = std::to_integer<unsigned>(bits[bit / 8]);
      const std::size_t next = std::min((bit / 8 + 1) * 8, begin + pixels);
      for (; byte != 0 && bit < next; ++bit)
        if ((byte >> (bit % 8) & 1U) != 0) see(bit - begin);
      bit = next;
    }
  }
};

Result<FramePixels> read_bits(const SegmentationFile& file) {
  const DicomHeader& header = file.header;
  FramePixels pixels;
  const std::size_t frames = header.planes.size();
  pixels.frames_begin_bytes = file.frames.begin_bytes || !header.pixels->fragments.empty();
  const std::size_t bytes =
      pixels.frames_begin_bytes ? frames * ((file.pixels() + 7) / 8) : (frames * file.pixels() + 7) / 8;
  if (const auto enough = check_memory(header.path, static_cast<double>(bytes)); !enough) return fail(enough.error());
  if (auto read = read_dicom_bits(header, bytes, pixels.bits, file.progress); !read) return fail(read.error());
  return pixels;
}

Result<FramePixels> read_values(const SegmentationFile& file) {
  if (file.frames.kind != SegmentFrames::Kind::fractional)
    if (auto exact = check_exact(file.header); !exact) return fail(exact.error());
  DicomHeader header = file.header;
  header.photometric = "MONOCHROME2";  // the indices of a palette are the labels
  const auto type = dicom_stored_type(header);
  if (!type) return fail(type.error());
  const std::size_t all = file.pixels() * header.planes.size();
  if (const auto credible = check_pixel_claim(header, file.pixels() * size_of(*type)); !credible)
    return fail(credible.error());
  if (const auto enough = check_memory(header.path, static_cast<double>(all * size_of(*type))); !enough)
    return fail(enough.error());
  FramePixels pixels;
  pixels.values = make_stored_voxels(*type, 0);
  reserve_voxels(pixels.values, all);
  const auto room = [&](std::size_t bytes) { return add_voxels(pixels.values, bytes / size_of(*type)); };
  if (auto read = read_dicom_pixels(header, room, file.progress); !read) return fail(read.error());
  return pixels;
}

/// The frames of each segment. Errors: two of one segment at one place.
Result<std::map<int, std::vector<std::size_t>>> frames_by_segment(const SegmentationFile& file) {
  std::map<int, std::vector<std::size_t>> by_segment;
  std::map<std::pair<int, int>, std::size_t> taken;
  for (std::size_t f = 0; f < file.frames.numbers.size(); ++f) {
    const int number = file.frames.numbers[f];
    const auto [at, is_new] = taken.try_emplace(std::pair(number, file.lattice.slices[f]), f);
    if (!is_new)
      return fail(file.name(), "has two frames (" + std::to_string(at->second + 1) + " and " + std::to_string(f + 1) +
                                   ")" + (number > 0 ? " of segment " + std::to_string(number) : std::string()) +
                                   " at one place, so that it does not tell which counts; export it again");
    by_segment[number].push_back(f);
  }
  return by_segment;
}

/// Puts volumes behind one another as the layers of the result. Errors: those of keep_voxels.
Result<void> add_layer(const SegmentationFile& file, StoredVoxels voxels, std::vector<Volume>& layers) {
  Volume& layer = layers.emplace_back();
  layer.geometry = file.lattice.geometry;
  layer.series_uid = file.header.series_uid;
  layer.modality = file.header.modality;
  layer.frame_of_reference = file.header.frame_of_reference;
  std::vector<std::string> none;
  return keep_voxels(std::move(voxels), {}, file.name(), layer, none);
}

/// Binary segments, each in the first layer in which it overlaps none.
template <class Label>
Result<std::vector<Volume>> binary_layers(const SegmentationFile& file, const FramePixels& pixels,
                                          Segmentation& segmentation) {
  const auto by_segment = frames_by_segment(file);
  if (!by_segment) return fail(by_segment.error());
  std::vector<std::vector<Label>> layers(1, std::vector<Label>(file.lattice.geometry.voxels()));
  std::size_t done = 0;
  for (Segment segment : file.frames.segments) {
    if (auto on = file.go_on(done++, file.frames.segments.size()); !on) return fail(on.error());
    const auto found = by_segment->find(segment.value);
    const std::vector<std::size_t> own = found == by_segment->end() ? std::vector<std::size_t>() : found->second;
    const auto overlaps = [&](const std::vector<Label>& layer) {
      bool any = false;
      for (const std::size_t f : own)
        pixels.for_each_set(f, file.pixels(), [&](std::size_t p) { any = any || layer[file.begin(f) + p] != 0; });
      return any;
    };
    const auto free = std::find_if_not(layers.begin(), layers.end(), overlaps);
    segment.layer = static_cast<std::size_t>(free - layers.begin());
    if (free == layers.end()) {
      if (auto enough = file.room_for(1, sizeof(Label)); !enough) return fail(enough.error());
      layers.emplace_back(file.lattice.geometry.voxels());
    }
    for (const std::size_t f : own)
      pixels.for_each_set(f, file.pixels(), [&](std::size_t p) {
        layers[segment.layer][file.begin(f) + p] = static_cast<Label>(segment.value);
      });
    segmentation.add(std::move(segment));
  }
  std::vector<Volume> result;
  for (auto& layer : layers)
    if (auto added = add_layer(file, std::move(layer), result); !added) return fail(added.error());
  return result;
}

/// The segments by names that tell them apart: of a name that others have, or none, the number is a part. Soft masks
/// are chosen by their names alone, since each is label 1.
std::vector<Segment> told_apart(std::vector<Segment> segments) {
  std::map<std::string, int> times;
  for (const Segment& segment : segments) ++times[lower_case(segment.name)];
  for (Segment& segment : segments) {
    const std::string number = "segment " + std::to_string(segment.value);
    if (segments.size() > 1 && segment.name.empty())
      segment.name = number;
    else if (times[lower_case(segment.name)] > 1)
      segment.name += " (" + number + ")";
  }
  return segments;
}

/// Fractional segments, each a soft mask.
Result<std::vector<Volume>> soft_layers(const SegmentationFile& file, const FramePixels& pixels,
                                        Segmentation& segmentation) {
  const auto by_segment = frames_by_segment(file);
  if (!by_segment) return fail(by_segment.error());
  const auto count = static_cast<double>(file.frames.segments.size());
  if (auto enough = file.room_for(count, sizeof(float)); !enough) return fail(enough.error());
  std::vector<Volume> layers;
  for (Segment& segment : told_apart(file.frames.segments)) {
    if (auto on = file.go_on(layers.size(), file.frames.segments.size()); !on) return fail(on.error());
    std::vector<float> shares(file.lattice.geometry.voxels());
    double most = 0;
    if (const auto found = by_segment->find(segment.value); found != by_segment->end())
      for (const std::size_t f : found->second)
        std::visit(
            [&](const auto& all) {
              for (std::size_t p = 0; p < file.pixels(); ++p) {
                const auto stored = static_cast<double>(all[f * file.pixels() + p]);
                most = std::max(most, stored);
                shares[file.begin(f) + p] = static_cast<float>(stored / file.frames.full);
              }
            },
            pixels.values);
    if (most > file.frames.full)
      return fail(file.name(), "holds the value " + std::to_string(static_cast<int>(most)) +
                                   ", above the one that it gives for a whole voxel (" +
                                   std::to_string(static_cast<int>(file.frames.full)) + "); export it again");
    segment.layer = layers.size();
    segment.value = 1;
    segmentation.add(std::move(segment));
    if (auto added = add_layer(file, std::move(shares), layers); !added) return fail(added.error());
  }
  return layers;
}

/// A label map: the values as they are, but 0 where the file keeps another value for what is in no segment. Values that
/// the file does not describe are named in `warnings`.
Result<std::vector<Volume>> label_layer(const SegmentationFile& file, const FramePixels& pixels,
                                        Segmentation& segmentation, std::vector<std::string>& warnings) {
  if (const auto placed = frames_by_segment(file); !placed) return fail(placed.error());
  if (auto enough = file.room_for(1, sizeof(std::uint16_t)); !enough) return fail(enough.error());
  std::vector<std::uint16_t> labels(file.lattice.geometry.voxels());
  std::set<int> held;
  bool beyond = false;
  std::visit(
      [&](const auto& all) {
        for (std::size_t f = 0; f < file.lattice.slices.size(); ++f)
          for (std::size_t p = 0; p < file.pixels(); ++p) {
            const auto value = static_cast<std::int64_t>(all[f * file.pixels() + p]);
            if (value == file.frames.background) continue;
            beyond = beyond || value <= 0 || value > std::numeric_limits<std::uint16_t>::max();
            const auto label = static_cast<std::uint16_t>(value);
            if (held.empty() || label != *held.begin()) held.insert(label);
            labels[file.begin(f) + p] = label;
          }
      },
      pixels.values);
  if (beyond)
    return fail(file.name(),
                "has a segment whose number is 0 or no label; export it again with segments numbered from 1 to 65535");
  for (const Segment& segment : file.frames.segments)
    if (segment.value != file.frames.background && segment.value != 0) segmentation.add(segment);
  for (const int label : held)
    if (!segmentation.find(label))
      warnings.push_back(file.name() + ": holds label " + std::to_string(label) +
                         ", which it does not describe, so that it has no name");
  std::vector<Volume> layers;
  if (held.empty() || *held.rbegin() <= 255) {
    std::vector<std::uint8_t> small(labels.begin(), labels.end());
    if (auto added = add_layer(file, std::move(small), layers); !added) return fail(added.error());
  } else if (auto added = add_layer(file, std::move(labels), layers); !added) {
    return fail(added.error());
  }
  return layers;
}

/// Whether the file holds a slice without a voxel, so that it leaves none out for that.
bool keeps_empty_slices(const SegmentationFile& file, const std::vector<Volume>& layers) {
  const std::set<int> held(file.lattice.slices.begin(), file.lattice.slices.end());
  return std::ranges::any_of(held, [&](int slice) {
    const auto begin = static_cast<std::ptrdiff_t>(file.pixels()) * slice;
    const auto end = begin + static_cast<std::ptrdiff_t>(file.pixels());
    return std::ranges::all_of(layers, [&](const Volume& layer) {
      return std::visit(
          [&](const auto& all) {
            return std::all_of(all.begin() + begin, all.begin() + end, [](const auto voxel) { return voxel == 0; });
          },
          layer.data);
    });
  });
}

/// Errors: the file holds a part of the frames alone [DICOM PS3.3, C.7.6.16.2.2.4].
Result<void> check_whole(const DicomSet& set) {
  constexpr DicomTag number_tag = 0x00209162, total_tag = 0x00209163;
  const auto number = binary_number_of(set.elements, number_tag, set.big_endian),
             total = binary_number_of(set.elements, total_tag, set.big_endian);
  const bool divided = total ? *total > 1 : number.has_value();
  if (!divided) return {};
  const auto words = [](const std::optional<double>& count) {
    return count ? std::to_string(static_cast<long>(*count)) : std::string("?");
  };
  return fail(set.path.string(), "is part " + words(number) + " of " + words(total) +
                                     " of a segmentation that lies in several files (a concatenation), so that it "
                                     "lacks the frames of the others; export it as one file");
}

Result<VolumeRead> place_voxels(const SegmentationFile& file, VolumeRead result) {
  using Kind = SegmentFrames::Kind;
  const bool packed = file.header.bits_allocated == 1;
  if (packed && file.frames.kind != Kind::binary)
    return fail(file.name(), "keeps single bits, though it is no binary segmentation; export it again");
  const auto pixels = packed ? read_bits(file) : read_values(file);
  if (!pixels) return fail(pixels.error());
  if (auto enough = file.room_for(1, 2); !enough) return fail(enough.error());
  const bool small = file.frames.segments.back().value <= 255;
  auto layers = file.frames.kind == Kind::label_map ? label_layer(file, *pixels, result.segmentation, result.warnings)
                : file.frames.kind == Kind::fractional ? soft_layers(file, *pixels, result.segmentation)
                : small                                ? binary_layers<std::uint8_t>(file, *pixels, result.segmentation)
                        : binary_layers<std::uint16_t>(file, *pixels, result.segmentation);
  if (!layers) return fail(layers.error());
  if (!file.on_series && !keeps_empty_slices(file, *layers))
    for (Volume& layer : *layers) layer.empty_beyond_slices = true;
  if (layers->size() > 1)
    result.about_layers = file.name() + ": its segments " +
                          (file.frames.kind == Kind::fractional ? "are fractional" : "overlap") +
                          ", so they are kept in " + std::to_string(layers->size()) + " layers; --label names one";
  result.volume = std::move(layers->front());
  layers->erase(layers->begin());
  result.other_layers = std::move(*layers);
  return result;
}

}  // namespace

bool is_dicom_segmentation(const DicomSet& set) {
  const std::string storage = text_of(set.elements, 0x00080016);
  return storage == "1.2.840.10008.5.1.4.1.1.66.4" || storage == "1.2.840.10008.5.1.4.1.1.66.7" ||
         (text_of(set.elements, 0x00080060) == "SEG" && item_of(set.elements, 0x00620002, 0) != nullptr);
}

ReferencedImages segmented_images(const DicomSet& set) {
  ReferencedImages images;
  images.study = text_of(set.elements, 0x0020000d);
  const auto add = [&](const DicomItem& item, DicomTag sequence) {
    for (std::size_t k = 0;; ++k) {
      const DicomItem* image = item_of(item, sequence, k);
      if (image == nullptr) return;
      if (std::string uid = text_of(*image, 0x00081155); !uid.empty()) images.instances.push_back(std::move(uid));
    }
  };
  for (std::size_t k = 0;; ++k) {
    const DicomItem* series = item_of(set.elements, 0x00081115, k);
    if (series == nullptr) break;
    if (std::string uid = text_of(*series, 0x0020000e); !uid.empty()) images.series.push_back(std::move(uid));
    add(*series, 0x0008114a);
  }
  constexpr DicomTag frames = 0x52009230, derivation = 0x00089124, source = 0x00082112;
  for (std::size_t f = 0;; ++f) {
    const DicomItem* frame = item_of(set.elements, frames, f);
    if (frame == nullptr) return images;
    if (const DicomItem* made = item_of(*frame, derivation, 0)) add(*made, source);
  }
}

Result<VolumeRead> read_dicom_segmentation(const DicomSet& set, const std::optional<ImageGrid>& series,
                                           Progress* progress) {
  const DicomHeader header = dicom_header(set);
  if (!header.is_image())
    return fail(
        set.path.string(),
        "is a segmentation without frames (one of surfaces has none); export it as a binary one or a label map");
  if (header.pixels_missing)
    return fail(set.path.string(), "is cut short: pixels are missing; copy or download it again");
  if (auto whole = check_whole(set); !whole) return fail(whole.error());
  const auto frames = segment_frames(set, header);
  if (!frames) return fail(frames.error());
  VolumeRead result;
  result.segments_are_own = true;
  result.referenced = segmented_images(set);
  result.warnings = frames->warnings;
  auto lattice = series ? lattice_on_series(frames->placed, *series) : std::nullopt;
  const bool on_series = lattice.has_value();
  if (!lattice) {
    auto own = lattice_of(set.path, frames->placed, result.warnings);
    if (!own) return fail(own.error());
    lattice = std::move(*own);
  }
  const std::vector<SourceImage> none;
  const auto doubts = doubts_about_places(set.path, frames->placed, *lattice, on_series ? series->images : none);
  result.warnings.insert(result.warnings.end(), doubts.begin(), doubts.end());
  const bool on_old_slices = lattice->old_slices;
  auto read = place_voxels({header, *frames, std::move(*lattice), on_series, progress}, std::move(result));
  if (!read || !on_old_slices) return read;
  std::vector<Volume*> layers{&read->volume};
  for (Volume& layer : read->other_layers) layers.push_back(&layer);
  for (Volume* layer : layers)
    if (auto taken = take_slices(set.path, *series->resampled, series->geometry, *layer); !taken)
      return fail(taken.error());
  read->warnings.push_back(taken_sentence(set.path, "frames", *series->resampled, series->geometry));
  return read;
}

}  // namespace homolog
