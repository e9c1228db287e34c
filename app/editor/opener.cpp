#include "app/editor/opener.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <mutex>

#include "app/editor/demo.h"
#include "app/editor/file_browser.h"

namespace homolog {

namespace fs = std::filesystem;

struct Opener::Box {
  std::mutex mutex;
  std::optional<Opened> opened;
};

namespace {

bool ends_with_any(const fs::path& path, const std::vector<std::string>& extensions) {
  std::string name = path.filename().string();
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return std::any_of(extensions.begin(), extensions.end(), [&](const auto& e) { return name.ends_with(e); });
}

/// A template whose x and y are negated: read as LPS, it was RAS.
Result<std::shared_ptr<const Template>> flipped(const Template& reference) {
  MeshFile mesh = to_mesh_file(reference);
  mesh.points.leftCols<2>() *= -1;
  for (Landmark& landmark : mesh.landmarks) landmark.position.head<2>() *= -1;
  return make_template(std::move(mesh), reference.source);
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
    auto read = open_case(request.case_file, &progress);
    if (!read) return fail(read.error());
    opened.warnings = read->warnings;
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
    opened.volume = std::make_shared<const Volume>(std::move(read->volume));
  }
  if (!request.template_source.empty()) {
    auto reference = load_template(request.template_source);
    if (reference && request.flip_lps_ras) reference = flipped(**reference);
    if (!reference) return fail(reference.error());
    opened.reference = std::move(*reference);
  }
  if (!request.labels.empty()) {
    VolumeReadOptions options;
    options.progress = &progress;
    auto read = read_volume(request.labels, options);
    if (!read) return fail(read.error());
    opened.labels = std::make_shared<const Volume>(std::move(read->volume));
  }
  return {};
}

}  // namespace

Result<OpenRequest> sort_files(const std::vector<fs::path>& paths) {
  OpenRequest request;
  for (const fs::path& path : paths) {
    std::error_code ignored;
    const bool folder = fs::is_directory(path, ignored);
    if (!folder && ends_with_any(path, purpose_extensions(FilePurpose::save_case))) {
      if (!request.case_file.empty()) return fail(path.string(), "is a second case; open one case at a time");
      request.case_file = path;
    } else if (!folder && ends_with_any(path, purpose_extensions(FilePurpose::open_template))) {
      if (!request.template_source.empty()) return fail(path.string(), "is a second template; open one at a time");
      request.template_source = path.string();
    } else {
      if (!request.volume_source.empty()) return fail(path.string(), "is a second image; open one image at a time");
      request.volume_source = path.string();
    }
  }
  return request;
}

Opener::~Opener() {
  progress_->cancel();
  if (thread_.joinable()) thread_.join();
}

void Opener::start(OpenRequest request) {
  progress_->cancel();
  if (thread_.joinable()) thread_.join();
  progress_ = std::make_shared<Progress>();
  box_ = std::make_shared<Box>();
  const std::string source = request.demo                     ? std::string("the demo case")
                             : !request.case_file.empty()     ? request.case_file.string()
                             : !request.volume_source.empty() ? request.volume_source
                             : !request.labels.empty()        ? request.labels.string()
                                                              : request.template_source;
  what_ = fs::path(source).filename().string();
  started_ = std::chrono::steady_clock::now();
  busy_ = true;
  thread_ = std::thread([box = box_, progress = progress_, wake = wake_, request = std::move(request)]() mutable {
    Opened opened;
    opened.request = std::move(request);
    if (auto done = open_parts(opened, *progress); !done) opened.error = done.error().sentence();
    opened.cancelled = progress->cancelled();
    {
      const std::lock_guard lock(box->mutex);
      box->opened = std::move(opened);
    }
    wake();
  });
}

double Opener::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
}

std::optional<Opened> Opener::take() {
  if (!busy_) return std::nullopt;
  std::optional<Opened> opened;
  {
    const std::lock_guard lock(box_->mutex);
    opened = std::exchange(box_->opened, std::nullopt);
  }
  if (opened) {
    thread_.join();
    busy_ = false;
  }
  return opened;
}

}  // namespace homolog
