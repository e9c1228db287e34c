#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "core/base/progress.h"
#include "core/case/case_file.h"
#include "core/phantom/phantom.h"

namespace homolog {

/// What is to be opened; empty parts are not asked for.
struct OpenRequest {
  std::filesystem::path case_file;
  std::string volume_source;  ///< beside a case: where its image lies now
  VolumeReadOptions volume_options;
  std::string template_source;  ///< path, or "built-in:kidney"
  std::filesystem::path labels;
  std::optional<std::pair<Organ, int>> demo;  ///< a phantom's subject, with its template placed
  std::shared_ptr<const Volume> beside;       ///< the image on the screen: a label map on its voxels is shown over it
};

/// Sorts paths into a case, a volume, a template, by their names. Errors: more than one of a kind, a case with a
/// template.
Result<OpenRequest> sort_files(const std::vector<std::filesystem::path>& paths);

struct Opened {
  OpenRequest request;
  std::optional<CaseRead> opened_case;
  std::optional<Document> demo;
  std::shared_ptr<const Volume> volume;
  std::shared_ptr<const Template> reference;
  std::shared_ptr<const Volume> labels;
  std::vector<std::string> warnings;
  std::vector<SeriesInfo> series;  ///< the folder holds several and none was chosen: nothing was opened
  bool needs_spacing = false;      ///< a stack of pictures, whose voxel size was not told: nothing was opened
  std::string error;               ///< the sentence, where it failed; empty also where it was cancelled
  bool cancelled = false;
};

/// Reads files on a thread of its own, one request at a time.
class Opener {
 public:
  /// `wake` is called from the thread when it is done.
  explicit Opener(std::function<void()> wake) : wake_(std::move(wake)) {}
  ~Opener();
  Opener(const Opener&) = delete;
  Opener& operator=(const Opener&) = delete;

  /// Starts, or cancels what runs and starts when that has stopped.
  void start(OpenRequest request);
  void cancel();
  bool busy() const { return busy_; }
  double fraction() const { return progress_->fraction(); }
  const std::string& what() const { return what_; }
  double seconds() const;
  /// The result, once.
  std::optional<Opened> take();

 private:
  struct Box;
  std::function<void()> wake_;
  std::shared_ptr<Progress> progress_ = std::make_shared<Progress>();
  std::shared_ptr<Box> box_;
  std::thread thread_;
  std::optional<OpenRequest> next_;
  std::string what_;
  std::chrono::steady_clock::time_point started_;
  bool busy_ = false;
};

}  // namespace homolog
