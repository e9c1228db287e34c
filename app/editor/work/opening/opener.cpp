#include "app/editor/work/opening/opener.h"

#include <algorithm>
#include <set>
#include <utility>

#include "app/editor/work/opening/demo.h"
#include "app/editor/work/opening/sample.h"
#include "app/editor/work/opening/sort_files.h"
#include "core/catalogue/catalogue.h"
#include "core/experiment/demo_case.h"
#include "core/template_making/label_body.h"
#include "core/volume/dicom/dicom_series.h"
#include "core/volume/labels/label_likeness.h"
#include "core/volume/labels/read_labels.h"
#include "core/volume/referenced_images.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// Whether a volume holds labels for the image, on the same voxels.
bool is_label_map_on(const Volume& volume, const Volume& image) {
  return on_same_voxels(volume, image) && holds_labels(volume);
}

/// Whether an image that is opened by itself is a label map, to which templates can be fitted.
bool is_label_map_alone(const VolumeRead& read, const OpenRequest& request) {
  // A label map is read once more, by its name alone.
  const VolumeReadOptions& how = request.volume_options;
  if (!request.labels.empty() || !names_file(request.volume_source) || how.stack_spacing_mm || !how.series_uid.empty())
    return false;
  return std::ranges::any_of(read.segmentation.segments, [](const Segment& one) { return !one.name.empty(); }) ||
         label_likeness(read.volume) == LabelLikeness::few_small_values;
}

/// `layer`: which it is of the map's; what is `known` of a map of one layer is of that one.
LabelMapLayer layer_of(Volume labels, const Segmentation& known, bool one_of_several, std::size_t layer) {
  LabelMapLayer taken;
  std::map<int, Rgb> colours;
  std::set<int> values;  // of any frame: a cine's labels may come later
  for (int frame = 0; frame < labels.frames; ++frame)
    for (const auto& [value, voxels] : labels_of(labels, frame)) values.insert(value);
  for (const int value : values) {
    taken.values.push_back(value);
    const Segment* segment = one_of_several ? known.find(value, layer) : known.find(value);
    if (segment == nullptr) continue;
    if (!segment->name.empty()) taken.names[value] = segment->name;
    if (!segment->colour) continue;
    for (std::size_t c = 0; c < 3; ++c) colours[value][c] = static_cast<float>((*segment->colour)[c]) / 255;
  }
  if (!colours.empty()) taken.colours = std::make_shared<const std::map<int, Rgb>>(std::move(colours));
  constexpr std::size_t most_sized = 256;  // a grey image has thousands of values, and no sizes that anybody wants
  for (int frame = 0; frame < labels.frames && taken.values.size() <= most_sized; ++frame)
    taken.sizes_mm.merge(label_sizes_mm(labels, frame));
  taken.volume = std::make_shared<const Volume>(std::move(labels));
  return taken;
}

void take_labels(Opened& opened, VolumeRead read) {
  const bool has_layers = !read.other_layers.empty();
  const auto take = [&](Volume& labels) {
    opened.labels.push_back(layer_of(std::move(labels), read.segmentation, has_layers, opened.labels.size()));
  };
  opened.labels.clear();
  take(read.volume);
  for (Volume& other : read.other_layers) take(other);
}

std::string shown_as_labels(const fs::path& file) {
  return file.filename().string() +
         " is shown as a label map over the image, because it has the same voxels, and values that are alike in whole "
         "regions.";
}

/// "ct.nii.gz", for the progress bar.
std::string name_of(const OpenRequest& request) {
  if (request.demo) return "the demo case";
  const std::string source = !request.case_file.empty()       ? request.case_file.string()
                             : !request.volume_source.empty() ? request.volume_source
                             : !request.labels.empty()        ? request.labels.string()
                             : request.template_source.empty() && !request.contours.empty()
                                 ? request.contours.front().string()
                                 : request.template_source;
  // A folder may be given with a slash at its end.
  const fs::path path = fs::path(source).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

/// The grid that a segmentation gets which is read beside an image. Nothing beside one that is a segmentation itself.
std::optional<ImageGrid> grid_beside(const Volume* image) {
  if (image == nullptr || image->empty_beyond_slices) return {};
  // Images of slices that were resampled are no slices of the grid.
  return ImageGrid{image->geometry, image->frame_of_reference,
                   image->resampled ? std::vector<SourceImage>() : image->images};
}

/// Errors: labels that were drawn on another scan than the image; of other images of it a warning. `image_name`: what
/// the image is called.
Result<void> check_labels(Opened& opened, const fs::path& file, const VolumeRead& labels, const Volume* image,
                          const std::string& image_name) {
  if (image == nullptr) return {};
  auto other = check_scan(file, labels.volume.frame_of_reference, labels.referenced, image_name, *image);
  if (!other) return fail(other.error());
  if (*other) opened.warnings.push_back(std::move(**other));
  return {};
}

/// What is no even stack about the slices of a DICOM series that was refused; empty: nothing, or it is something else.
std::string uneven_slices(const OpenRequest& request, Progress& progress) {
  if (request.volume_options.resample || progress.cancelled() || !names_file(request.volume_source)) return {};
  const auto series = read_dicom_series(request.volume_source, &progress, true, request.volume_options.series_uid);
  return series ? series->arrangement.uneven : std::string();
}

constexpr const char* image_on_screen = "the image that is open";

/// Takes the volume that was read first as the image over which the other lies as a label map, or the other way round.
Result<void> take_pair(Opened& opened, VolumeRead first, Progress& progress) {
  OpenRequest& request = opened.request;
  VolumeReadOptions options;
  options.progress = &progress;
  options.stack_spacing_mm = request.volume_options.stack_spacing_mm;
  options.image = grid_beside(&first.volume);
  auto other = load_volume(request.other_source, options);
  if (!other) return fail(other.error());
  if (first.volume.empty_beyond_slices) {
    options.image = grid_beside(&other->volume);
    if (auto on_other = load_volume(request.volume_source, options)) first = std::move(*on_other);
  }
  opened.warnings.insert(opened.warnings.end(), other->warnings.begin(), other->warnings.end());
  const auto likeness = [](const Volume& map, const Volume& image) {
    return on_same_voxels(map, image) ? label_likeness(map) : LabelLikeness::none;
  };
  const LabelLikeness of_first = likeness(first.volume, other->volume),
                      of_other = likeness(other->volume, first.volume);
  // Of two that look like label maps the one that says so is it.
  const bool says_first = first.volume.modality == "SEG", says_other = other->volume.modality == "SEG";
  if (of_first == of_other && (of_first == LabelLikeness::none || says_first == says_other)) {
    const std::string name = fs::path(request.volume_source).filename().string();
    if (says_other)  // of another scan it has other voxels too
      if (auto checked = check_labels(opened, request.other_source, *other, &first.volume, name); !checked)
        return checked;
    if (says_first)
      if (auto checked = check_labels(opened, request.volume_source, first, &other->volume, request.other_source);
          !checked)
        return checked;
    return fail(second_image(request.other_source,
                             of_first != LabelLikeness::none
                                 ? ", and the program cannot tell whether it or " + name + " is the label map"
                                 : ", and not a label map with the voxels of " + name));
  }
  const bool first_is_map = of_first == of_other ? says_first : of_first > of_other;
  if (first_is_map) {
    std::swap(first, *other);
    std::swap(request.volume_source, request.other_source);
  }
  if (auto checked = check_labels(opened, request.other_source, *other, &first.volume, request.volume_source); !checked)
    return checked;
  opened.volume = std::make_shared<const Volume>(std::move(first.volume));
  request.labels = std::exchange(request.other_source, {});  // both are known by now
  take_labels(opened, std::move(*other));
  opened.warnings.push_back(shown_as_labels(request.labels));
  return {};
}

/// The image that is asked for, with its label map where there are two; or a label map for the image on the screen.
Result<void> open_volume(Opened& opened, Progress& progress) {
  OpenRequest& request = opened.request;
  VolumeReadOptions options = request.volume_options;
  options.progress = &progress;
  if (!options.stack_spacing_mm && is_picture_stack(request.volume_source)) {
    opened.needs_spacing = true;
    return {};
  }
  std::error_code ignored;
  if (options.series_uid.empty() && fs::is_directory(request.volume_source, ignored)) {
    auto series = list_series(request.volume_source);
    if (series && series->size() > 1) {
      opened.series = std::move(*series);
      return {};
    }
  }
  if (request.template_source.empty()) options.image = grid_beside(request.beside.get());
  auto read = load_volume(request.volume_source, options);
  if (!read) {
    opened.uneven = uneven_slices(request, progress);
    if (!opened.uneven.empty()) return {};
    return fail(read.error());
  }
  opened.warnings = std::move(read->warnings);
  if (!request.other_source.empty()) {
    if (auto taken = take_pair(opened, std::move(*read), progress); !taken) return fail(taken.error());
  } else if (request.template_source.empty() && request.beside && is_label_map_on(read->volume, *request.beside)) {
    request.labels = request.volume_source;
    if (auto checked = check_labels(opened, request.labels, *read, request.beside.get(), image_on_screen); !checked)
      return checked;
    take_labels(opened, std::move(*read));
    opened.warnings.push_back(shown_as_labels(request.labels));
    return {};
  } else {
    if (is_label_map_alone(*read, request)) request.labels = request.volume_source;
    opened.volume = std::make_shared<const Volume>(std::move(read->volume));
  }
  return {};
}

/// The image that is on the screen once this is open; null where there is none.
const Volume* shown_image(const Opened& opened, const Volume* on_screen) {
  if (opened.volume) return opened.volume.get();
  return opened.opened_case ? opened.opened_case->session.document().scan.image.get() : on_screen;
}

Result<void> open_labels(Opened& opened, const Volume* on_screen, Progress& progress) {
  VolumeReadOptions options;
  options.progress = &progress;
  const Volume* const image = shown_image(opened, on_screen);
  options.image = grid_beside(image);
  auto read = read_labels(opened.request.labels, options);
  if (!read) return fail(read.error());
  if (auto checked = check_labels(opened, opened.request.labels, *read, image, image_on_screen); !checked)
    return checked;
  opened.warnings.insert(opened.warnings.end(), read->warnings.begin(), read->warnings.end());
  take_labels(opened, std::move(*read));
  return {};
}

/// The label map that a case was left with; where it cannot be read, a warning says so.
Result<void> read_kept_labels(Opened& opened, Progress& progress) {
  const fs::path kept = opened.opened_case->session.kept().labels;
  if (kept.empty()) return {};
  opened.request.labels = kept;
  auto read = open_labels(opened, nullptr, progress);
  if (read) return {};
  if (progress.cancelled()) return read;
  opened.request.labels.clear();
  std::error_code ignored;
  opened.warnings.push_back(
      fs::exists(kept, ignored)
          ? "The label map of this case cannot be shown: " + read.error().sentence()
          : "The label map of this case, " + kept.string() +
                ", is not there any more. Put it back, or open it from where it is now (Place, Open a label map).");
  return {};
}

/// The template that a case was saved to: where it was, or beside the case's file where the folder was moved.
void load_saved_template(Opened& opened) {
  const fs::path& saved = opened.opened_case->session.kept().template_file;
  if (saved.empty()) return;
  std::error_code ignored;
  const fs::path beside = opened.request.case_file.parent_path() / saved.filename();
  auto read = load_template((fs::exists(saved, ignored) ? saved : beside).string());
  if (read)
    opened.the_template = std::move(*read);
  else
    opened.warnings.push_back("The template of this case was saved as " + saved.string() +
                              ", which cannot be read now. The next image comes with the template that the case began "
                              "with.");
}

/// Whether a voxel of the first frame that has a label lies in the image.
bool lies_in(const Volume& labels, const VolumeGeometry& image) {
  const VolumeGeometry& grid = labels.geometry;
  return std::visit(
      [&](const auto& voxels) {
        auto voxel = voxels.begin();
        for (int k = 0; k < grid.dims[2]; ++k)
          for (int j = 0; j < grid.dims[1]; ++j)
            for (int i = 0; i < grid.dims[0]; ++i)
              if (rounded_label(static_cast<double>(*voxel++)) != 0 && image.holds(grid.to_mm(Vec3(i, j, k))))
                return true;
        return false;
      },
      labels.data);
}

/// Whether its labels miss the image, and why. `on_screen`: null where there is none.
void meet_image(Opened& opened, const Volume* on_screen) {
  const Volume* image = shown_image(opened, on_screen);
  if (image == nullptr) return;
  const auto is_empty = [](const LabelMapLayer& layer) { return layer.values.empty(); };
  const auto is_there = [&](const LabelMapLayer& layer) { return lies_in(*layer.volume, image->geometry); };
  if (std::ranges::all_of(opened.labels, is_empty) || std::ranges::any_of(opened.labels, is_there)) return;
  opened.labels_off_image = true;
  opened.labels_misfit = misfit_in_image(opened.labels.front().volume->geometry.bounds_mm(), image->geometry);
}

Result<void> open_parts(Opened& opened, const Volume* on_screen, Progress& progress) {
  OpenRequest& request = opened.request;
  if (request.demo) {
    if (request.demo->first == Organ::kidney && request.demo->second == 1) {
      auto first = first_case();
      if (!first) return fail(first.error());
      opened.demo = std::move(first->document);
      opened.guide = std::move(first->guide);
      return {};
    }
    auto demo = demo_document(request.demo->first, request.demo->second);
    if (!demo) return fail(demo.error());
    opened.demo = std::move(*demo);
    return {};
  }
  if (!request.case_file.empty()) {
    const bool read_only = is_write_protected(request.case_file);
    ReplayOptions options;
    options.progress = &progress;
    options.volume_source = request.volume_source;
    options.up_to_bad_line = true;
    auto read = read_only ? read_case(request.case_file, options)
                          : open_case(request.case_file, &progress, request.volume_source, {}, true);
    if (!read) return fail(read.error());
    opened.warnings = read->warnings;
    if (!read->fault.empty())
      opened.fault = read->fault +
                     ". You see the case as it was before that line. The file stays as it is, and your changes are "
                     "kept in a new case. Save it under another name.";
    else if (read_only)
      opened.warnings.push_back(request.case_file.string() +
                                " is read-only. Your changes are kept in a new case. Save it under another name.");
    opened.opened_case = std::move(*read);
    load_saved_template(opened);
    if (request.labels.empty()) return read_kept_labels(opened, progress);
    // A study's case opens without its label map where that was moved.
    if (auto labels = open_labels(opened, on_screen, progress); !labels && !progress.cancelled())
      opened.warnings.push_back(labels.error().sentence());
    return {};
  }
  if (auto made = make_sample(request); !made) return made;
  if (!request.volume_source.empty()) {
    if (auto done = open_volume(opened, progress); !done) return fail(done.error());
    if (!opened.volume) return {};  // a label map, or something is to be asked first
  }
  if (!request.template_source.empty()) {
    auto the_template = load_template(request.template_source);
    if (!the_template) return fail(the_template.error());
    opened.the_template = std::move(*the_template);
  }
  return request.labels.empty() || !opened.labels.empty() ? Result<void>() : open_labels(opened, on_screen, progress);
}

}  // namespace

void Opener::start(OpenRequest request, std::shared_ptr<const Volume> on_screen) {
  const std::string name = name_of(request);
  worker_.start(name, [request = std::move(request), on_screen](Progress& progress) -> Result<Opened> {
    Opened opened;
    opened.request = request;
    if (auto done = open_parts(opened, on_screen.get(), progress); !done) return fail(done.error());
    meet_image(opened, on_screen.get());
    return opened;
  });
}

}  // namespace homolog
