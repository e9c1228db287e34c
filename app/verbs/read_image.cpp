#include "app/verbs/read_image.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>

#include "core/base/text/listed.h"
#include "core/base/text/text.h"
#include "core/measure/compare.h"
#include "core/mesh/mesh_io.h"
#include "core/volume/dicom/dicom_set.h"
#include "core/volume/labels/label_boxes.h"
#include "core/volume/labels/read_labels.h"
#include "core/volume/labels/soft_mask.h"

namespace homolog {

namespace {

/// Those that are lent now; a name that is lent twice counts twice.
struct ImagesInMemory {
  std::mutex mutex;
  LentImages by_name;
} images_in_memory;

std::shared_ptr<const VolumeRead> image_in_memory(const std::filesystem::path& name) {
  const std::lock_guard lock(images_in_memory.mutex);
  const auto found = images_in_memory.by_name.find(name);
  return found == images_in_memory.by_name.end() ? nullptr : found->second;
}

}  // namespace

ImageInMemory::ImageInMemory(std::filesystem::path name, std::shared_ptr<const VolumeRead> image) {
  const std::lock_guard lock(images_in_memory.mutex);
  place_ = images_in_memory.by_name.emplace(std::move(name), std::move(image));
}

ImageInMemory::~ImageInMemory() {
  const std::lock_guard lock(images_in_memory.mutex);
  images_in_memory.by_name.erase(place_);
}

Result<VolumeRead> read_image(const std::filesystem::path& path, int frame, Progress& progress, bool resample,
                              const ReferencedImages& of_images) {
  constexpr double share_of_work = 0.05;  // what is done with an image takes longer than to read it
  Progress own(progress, share_of_work);
  VolumeReadOptions reading;
  reading.progress = &own;
  reading.resample = resample;
  reading.of_images = of_images;
  reading.names_no_series = true;
  const auto lent = image_in_memory(path);
  if (lent && resample) return fail(path.string(), "is in memory, so --resample has no effect; leave it out");
  if (auto usable = check_reading(path, "", false, resample); !usable) return fail(usable.error());
  if (!lent && is_mesh_name(path))
    return fail(path.string(),
                "is a mesh, where an image or a label map is wanted; fit takes it by --mesh, and label-map "
                "makes voxels of it");
  auto read = lent ? Result<VolumeRead>(*lent) : read_volume(path, reading);
  if (read && frame >= read->volume.frames)
    return fail(path.string(),
                "has " + std::to_string(read->volume.frames) + " frames, counted from 0; choose --frame among them");
  return read;
}

std::string frame_taken(const std::filesystem::path& path, int frames, int frame) {
  return path.string() + ": has " + std::to_string(frames) + " frames, of which frame " + std::to_string(frame) +
         " was taken; choose another by --frame";
}

CLI::Option* add_label_option(CLI::App& verb, std::string& label, const std::string& help) {
  return verb
      .add_option_function<std::string>(
          "--label",
          [&label](const std::string& text) {
            if (is_bad_label(text))
              throw CLI::ValidationError("--label",
                                         "needs a number above 0 or a name, or several as in 1,2; got " + text);
            label = text;
          },
          help)
      ->type_name("N|NAME[,...]");
}

CLI::Option* add_ball_option(CLI::App& verb, const std::string& name, std::optional<double>& radius_mm,
                             const std::string& help) {
  return verb
      .add_option_function<double>(
          name, [&radius_mm](const double& radius) { radius_mm = radius; },
          help + "; without it 0.00625 of the organ's size")
      ->check(CLI::NonNegativeNumber);
}

std::string MaskRead::named(std::string sentence) const {
  if (from.size() < 2) return sentence;
  const std::string one = "label " + std::to_string(label);
  std::string all = "label ";
  for (std::size_t k = 0; k < from.size(); ++k) all += (k > 0 ? "+" : "") + std::to_string(from[k]);
  for (std::size_t at = sentence.find(one + " "); at != std::string::npos; at = sentence.find(one + " ", at + 1))
    sentence.replace(at, one.size(), all);
  return sentence;
}

std::vector<std::string> MaskRead::named(std::vector<std::string> sentences) const {
  for (std::string& sentence : sentences) sentence = named(std::move(sentence));
  return sentences;
}

CLI::Option* add_mask_frame_option(CLI::App& verb, std::optional<int>& frame) {
  return verb
      .add_option_function<int>(
          "--frame", [&frame](const int& asked) { frame = asked; },
          "Which frame of a label map with several, from 0 (default: that of the mesh where it says so, else the "
          "first)")
      ->check(CLI::NonNegativeNumber);
}

CLI::Option* add_level_option(CLI::App& verb, std::optional<double>& level) {
  return verb
      .add_option_function<double>(
          "--level", [&level](const double& asked) { level = asked; },
          "Of a mask with soft edges: the value at its surface, below 1 where values are from 0 to 1 (default: 0.5), "
          "above 1 where they are from 0 to 255")
      ->check(CLI::Range(0.001, 254.0));
}

namespace {

/// "3–7 and 12"
std::string listed_frames(const std::vector<int>& frames) {
  std::vector<std::string> runs;
  for (std::size_t k = 0; k < frames.size();) {
    std::size_t last = k;
    while (last + 1 < frames.size() && frames[last + 1] == frames[last] + 1) ++last;
    runs.push_back(std::to_string(frames[k]) + (last > k ? "–" + std::to_string(frames[last]) : ""));
    k = last + 1;
  }
  constexpr std::size_t most = 8;
  if (runs.size() > most) {
    runs.resize(most);
    runs.back() = "…";
  }
  return listed(runs, " and ");
}

/// An error where a frame of several holds none of the labels, or no label at all where none is named.
Result<void> check_frame(const Volume& mask, const std::vector<int>& labels, int frame) {
  const auto holds = [&](int f) {
    const auto held = labels_of(mask, f);
    return labels.empty() ? !held.empty()
                          : std::any_of(labels.begin(), labels.end(), [&](int label) { return held.contains(label); });
  };
  if (mask.frames < 2 || holds(frame)) return {};
  std::vector<int> others;
  for (int f = 0; f < mask.frames; ++f)
    if (f != frame && holds(f)) others.push_back(f);
  std::string what = "label";
  for (std::size_t k = 0; k < labels.size(); ++k) what += (k > 0 ? "+" : " ") + std::to_string(labels[k]);
  const std::string none = "frame " + std::to_string(frame) + " holds no " + what;
  if (others.empty()) return fail("", none + ", nor does any other; name a label that occurs by --label");
  return fail("", none + "; give --frame " + std::to_string(others.front()) +
                      (others.size() > 1 ? ", or another of " + listed_frames(others) : ""));
}

/// "; kidney_left and liver are empty": the file's own segments that have no voxels; nothing where there are none.
std::string empty_ones(const VolumeRead& read, const std::map<int, std::size_t>& held) {
  if (!read.segments_are_own || !read.other_layers.empty()) return {};
  std::vector<std::string> names;
  constexpr std::size_t most = 8;
  for (const Segment& segment : read.segmentation.segments)
    if (!held.contains(segment.value))
      names.push_back(segment.name.empty() ? std::to_string(segment.value) : excerpt(segment.name));
  if (names.empty()) return {};
  const bool one = names.size() == 1;
  if (names.size() > most) {
    names.resize(most);
    names.emplace_back("…");
  }
  return "; " + listed(names, " and ") + (one ? " is empty" : " are empty");
}

/// "1, 2 (spleen) and 3" of what a frame holds.
std::string labels_there(const VolumeRead& read, int frame) {
  std::vector<std::string> names;
  constexpr std::size_t most = 20;
  const auto held = labels_of(read.volume, frame);
  for (const auto& [label, voxels] : held) {
    if (names.size() == most) {
      names.emplace_back("…");
      break;
    }
    const Segment* known = read.segmentation.find(label);
    names.push_back(std::to_string(label) +
                    (known && !known->name.empty() ? " (" + excerpt(known->name) + ")" : std::string()));
  }
  return (names.empty() ? "it holds none" : "it holds " + listed(names, " and ")) + empty_ones(read, held);
}

/// Whether a voxel of the frame has one of the labels.
bool any_occurs(const Volume& mask, const std::vector<int>& labels, int frame) {
  const std::size_t count = mask.geometry.voxels(), first = static_cast<std::size_t>(frame) * count;
  return std::visit(
      [&](const auto& voxels) {
        const auto begin = voxels.begin() + static_cast<std::ptrdiff_t>(first);
        return std::any_of(begin, begin + static_cast<std::ptrdiff_t>(count), [&](const auto value) {
          const int label = rounded_label(static_cast<double>(value));
          return label != 0 && std::find(labels.begin(), labels.end(), label) != labels.end();
        });
      },
      mask.data);
}

/// Errors: none of the labels occurs; those that do are named.
Result<void> check_labels(const VolumeRead& read, const std::vector<int>& labels, int frame) {
  if (labels.empty() || any_occurs(read.volume, labels, frame)) return {};
  std::string what = "label ";
  for (std::size_t k = 0; k < labels.size(); ++k) what += (k > 0 ? "+" : "") + std::to_string(labels[k]);
  return fail("", what + " does not occur in the label map; " + labels_there(read, frame));
}

/// The only label of a frame. Errors: none, or several, which are named.
Result<int> label_alone(const VolumeRead& read, int frame) {
  auto only = only_label(read.volume, frame);
  if (only) return only;
  if (labels_of(read.volume, frame).empty() || read.segmentation.segments.empty())
    return fail("", only.error().what + " by --label");
  return fail("", "holds several labels; choose one by --label: " + labels_there(read, frame));
}

/// Makes a soft mask of what is one, or is said to be one by its level, and gives the level; none of other masks.
Result<std::optional<double>> soft_level(const std::filesystem::path& path, VolumeRead& read, int frame,
                                         const MaskAsked& asked) {
  if (asked.voxels_alone || !read.other_layers.empty()) return std::nullopt;
  if (!asked.level && !is_soft(read.volume, frame)) return std::nullopt;
  const double level = asked.level.value_or(usual_level);
  const auto soft = make_soft(read.volume, frame, level);
  if (!soft) return fail(path.string(), soft.error().what);
  if (!*soft) return std::nullopt;
  if (!any_occurs(read.volume, {1}, frame))
    return fail(path.string(), "has no value above " + Json(level).dump() + "; give a lower --level");
  return level;
}

/// Of a folder of masks the soft one that is meant. None where it is not soft, or all labels of the map are wanted.
/// Errors: another level than that by which the folder became a label map.
Result<std::optional<MaskRead>> shares_of(const std::filesystem::path& path, VolumeRead& read,
                                          const std::vector<Segment>& wanted, const MaskAsked& asked) {
  if (read.soft.empty() || asked.voxels_alone || asked.among_others) return std::nullopt;
  const auto boxes = label_boxes(read.volume);
  if (wanted.empty() && boxes.size() != 1) return std::nullopt;  // said where the label is looked for
  const int value = wanted.empty() ? boxes.begin()->first : wanted.front().value;
  const std::size_t layer = wanted.empty() ? 0 : wanted.front().layer;
  const auto box = boxes.find(value);
  if (box == boxes.end()) return std::nullopt;
  const SoftSegment* soft = soft_of_label(read.soft, read.volume, box->second, value, layer);
  if (soft == nullptr) return std::nullopt;
  if (wanted.size() > 1) {
    read.warnings.push_back(path.string() + ": the soft masks are taken together as voxels, from 0.5 on");
    return std::nullopt;
  }
  if (asked.level && *asked.level != usual_level)
    return fail(path.string(),
                "is a folder, whose soft masks have their surfaces at 0.5; name one file of it where "
                "--level is to be another");
  const Segment* known = read.segmentation.find(value);
  Segment own{.name = known != nullptr ? known->name : std::string(), .value = 1};
  read.volume = soft_on_grid(*soft, read.volume);
  read.soft.clear();
  read.segmentation.segments = {std::move(own)};
  return MaskRead{std::move(read), 1, 0, {1}, usual_level};
}

}  // namespace

Result<MaskRead> read_mask(const std::filesystem::path& path, const std::string& label, const MaskAsked& asked,
                           Progress& progress) {
  auto read = read_image(path, asked.frame.value_or(0), progress);
  if (!read) return fail(read.error());
  return chosen_mask(std::move(*read), path, label, asked);
}

Result<MaskRead> chosen_mask(VolumeRead read, const std::filesystem::path& path, const std::string& label,
                             const MaskAsked& asked) {
  const auto segments = choose_segments(path, label, read);
  if (!segments) return fail(segments.error());
  std::vector<int> labels;
  for (const Segment& segment : *segments)
    if (std::find(labels.begin(), labels.end(), segment.value) == labels.end()) labels.push_back(segment.value);
  const int frames = read.volume.frames;
  const int frame = asked.frame ? *asked.frame : frames > 1 ? asked.of_mesh.value_or(0) : 0;
  if (frame >= frames)
    return fail(path.string(), "has " + std::to_string(frames) +
                                   " frames, counted from 0, and the mesh belongs to frame " + std::to_string(frame) +
                                   "; choose --frame among them");
  if (labels.size() < 2) {
    auto shares = shares_of(path, read, *segments, asked);
    if (!shares) return fail(shares.error());
    if (*shares) return std::move(**shares);
  }
  const auto level = soft_level(path, read, frame, asked);
  if (!level) return fail(level.error());
  if (auto held = check_frame(read.volume, labels, frame); !held) return fail(path.string(), held.error().what);
  if (auto there = check_labels(read, labels, frame); !there) return fail(path.string(), there.error().what);
  if (frames > 1 && !asked.frame && !asked.of_mesh) read.warnings.push_back(frame_taken(path, frames, 0));
  if (!*level) warn_of_soft_labels(path, read.volume, frame, read.warnings);
  if (labels.size() > 1 && !*level) {  // one that does not occur adds nothing: most kidneys have no tumour
    const int united = unite_segments(read.volume, *segments, frame);
    return MaskRead{std::move(read), united, frame, labels};
  }
  if (*level) return MaskRead{std::move(read), 1, frame, {1}, *level};
  const auto chosen = !labels.empty() ? Result<int>(labels.front()) : label_alone(read, frame);
  if (!chosen) return fail(path.string(), chosen.error().what);
  return MaskRead{std::move(read), *chosen, frame, {*chosen}};
}

void add_spacing_option(CLI::App& verb, std::vector<double>& spacing_mm) {
  verb.add_option("--spacing", spacing_mm, "X,Y,Z spacing in mm of a stack of PNG or TIFF slices")
      ->delimiter(',')
      ->expected(3)
      ->check(CLI::PositiveNumber);
}

void add_resample_option(CLI::App& verb, bool& resample) {
  verb.add_flag(
      "--resample", resample,
      "DICOM slices that are shifted sideways (a tilted gantry) or unevenly spaced become a rectangular grid, by "
      "linear interpolation; without it they are refused");
}

void report_resampled(const VolumeRead& read, Json& values) {
  if (!read.resampled) return;
  const ResampledSlices& done = *read.resampled;
  const Vec3& spacing = done.spacing_mm;
  values["resampled"] = {{"why", done.why},
                         {"from",
                          {{"slices", done.from_slices},
                           {"least_mm", done.least_mm},
                           {"most_mm", done.most_mm},
                           {"shifted_mm", done.shifted_mm}}},
                         {"to", {{"dims", done.dims}, {"spacing_mm", {spacing.x(), spacing.y(), spacing.z()}}}}};
}

VolumeReadOptions read_options(const std::string& series, const std::vector<double>& spacing_mm, Progress& progress,
                               bool resample) {
  VolumeReadOptions options;
  options.series_uid = series;
  options.progress = &progress;
  options.resample = resample;
  if (spacing_mm.size() == 3) options.stack_spacing_mm = Vec3(spacing_mm.data());
  return options;
}

Result<std::vector<std::string>> check_reading(const std::filesystem::path& path, const std::string& series,
                                               bool spacing, bool resample) {
  std::error_code ignored;
  const bool mesh = is_mesh_name(path);
  if (mesh && spacing) return fail(path.string(), "is a mesh, on which --spacing has no effect; leave it out");
  if (!series.empty() &&
      (mesh || (std::filesystem::exists(path, ignored) && !std::filesystem::is_directory(path, ignored))))
    return fail(path.string(), "is no folder of DICOM images, so --series has no effect; leave it out");
  if (resample && std::filesystem::exists(path, ignored) && !std::filesystem::is_directory(path, ignored) &&
      !looks_like_dicom(path))
    return fail(path.string(), "is no series of DICOM slices, so --resample has no effect; leave it out");
  std::vector<std::string> warnings;
  if (spacing && !is_picture_stack(path))
    warnings.push_back(path.string() + ": has a spacing of its own, so --spacing has no effect");
  return warnings;
}

}  // namespace homolog
