#include "app/editor/work/opener.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>

#include "app/editor/state/file_browser.h"
#include "app/editor/state/file_extensions.h"
#include "app/editor/update/demo.h"
#include "core/base/paths.h"
#include "core/base/text.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

bool ends_with_any(const fs::path& path, const std::vector<std::string>& extensions) {
  const std::string name = lower_case(path.filename().string());
  return std::any_of(extensions.begin(), extensions.end(), [&](const auto& e) { return name.ends_with(e); });
}

/// Whether a volume holds labels for the image: whole numbers, few of them, on the same voxels.
bool is_label_map_on(const Volume& volume, const Volume& image) {
  constexpr std::size_t most_labels = 32;
  const auto& a = volume.geometry;
  const auto& b = image.geometry;
  const bool same_voxels = a.dims == b.dims && a.spacing_mm.isApprox(b.spacing_mm, 1e-3) &&
                           a.direction.isApprox(b.direction, 1e-3) &&
                           (a.origin_mm - b.origin_mm).norm() < 0.1 * b.spacing_mm.minCoeff();
  const bool whole = !std::holds_alternative<std::vector<float>>(volume.data);
  return same_voxels && whole && volume.frames == 1 && volume.range_min >= 0 && volume.range_max <= 255 &&
         labels_of(volume).size() <= most_labels;
}

void take_labels(Opened& opened, Volume labels) {
  for (const auto& [value, voxels] : labels_of(labels)) opened.label_values.push_back(value);
  opened.labels = std::make_shared<const Volume>(std::move(labels));
}

/// "ct.nii.gz", for the progress bar.
std::string name_of(const OpenRequest& request) {
  if (request.demo) return "the demo case";
  const std::string source = !request.case_file.empty()       ? request.case_file.string()
                             : !request.volume_source.empty() ? request.volume_source
                             : !request.labels.empty()        ? request.labels.string()
                                                              : request.template_source;
  // A folder may be given with a slash at its end.
  const fs::path path = fs::path(source).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

Result<void> open_parts(Opened& opened, Progress& progress) {
  OpenRequest& request = opened.request;
  if (request.demo) {
    auto demo = demo_document(request.demo->first, request.demo->second);
    if (!demo) return fail(demo.error());
    opened.demo = std::move(*demo);
    return {};
  }
  if (!request.case_file.empty()) {
    const bool read_only =
        ::access(request.case_file.c_str(), R_OK) == 0 && ::access(request.case_file.c_str(), W_OK) != 0;
    ReplayOptions options;
    options.progress = &progress;
    options.volume_source = request.volume_source;
    auto read = read_only ? read_case(request.case_file, options)
                          : open_case(request.case_file, &progress, request.volume_source);
    if (!read) return fail(read.error());
    opened.warnings = read->warnings;
    if (read_only)
      opened.warnings.push_back(request.case_file.string() +
                                " is read-only. What you change is kept as a case of its own; save it elsewhere.");
    opened.opened_case = std::move(*read);
    return {};
  }
  if (!request.volume_source.empty()) {
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
    auto read = load_volume(request.volume_source, options);
    if (!read) return fail(read.error());
    opened.warnings = std::move(read->warnings);
    if (request.template_source.empty() && request.beside && is_label_map_on(read->volume, *request.beside)) {
      request.labels = request.volume_source;
      take_labels(opened, std::move(read->volume));
      opened.warnings.push_back(request.labels.filename().string() +
                                " is shown as a label map over the image: it has the same voxels and few values.");
      return {};
    }
    opened.volume = std::make_shared<const Volume>(std::move(read->volume));
  }
  if (!request.template_source.empty()) {
    auto reference = load_template(request.template_source);
    if (!reference) return fail(reference.error());
    opened.reference = std::move(*reference);
  }
  if (!request.labels.empty()) {
    VolumeReadOptions options;
    options.progress = &progress;
    auto read = read_volume(request.labels, options);
    if (!read) return fail(read.error());
    opened.warnings.insert(opened.warnings.end(), read->warnings.begin(), read->warnings.end());
    take_labels(opened, std::move(read->volume));
  }
  return {};
}

}  // namespace

Result<OpenRequest> sort_files(const std::vector<fs::path>& paths) {
  OpenRequest request;
  for (const fs::path& path : paths) {
    std::error_code ignored;
    const bool folder = fs::is_directory(path, ignored);
    if (!folder && ends_with_any(path, {case_extension})) {
      if (!request.case_file.empty()) return fail(path.string(), "is a second case; open one case at a time");
      request.case_file = absolute_path(path);  // as studies name it
    } else if (!folder && ends_with_any(path, mesh_extensions())) {
      if (!request.template_source.empty()) return fail(path.string(), "is a second template; open one at a time");
      request.template_source = path.string();
    } else {
      if (!request.volume_source.empty())
        return fail(path.string(),
                    "is a second image; open one at a time, a series of slices as the folder that holds them");
      request.volume_source = path.string();
    }
  }
  if (!request.case_file.empty() && !request.template_source.empty())
    return fail(request.case_file.string(),
                "is a case, which names its template; open it alone, or with its image where that has moved");
  return request;
}

void Opener::start(OpenRequest request) {
  const std::string name = name_of(request);
  worker_.start(name, [request = std::move(request)](Progress& progress) -> Result<Opened> {
    Opened opened;
    opened.request = request;
    if (auto done = open_parts(opened, progress); !done) return fail(done.error());
    return opened;
  });
}

}  // namespace homolog
