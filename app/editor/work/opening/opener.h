#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/editor/state/guide.h"
#include "app/editor/state/label_map_layer.h"
#include "app/editor/state/open_request.h"
#include "app/editor/work/worker.h"
#include "core/measure/meeting.h"
#include "core/mesh/colours.h"
#include "core/phantom/phantom.h"
#include "core/session/case_file.h"

namespace homolog {

struct Opened {
  OpenRequest request;
  std::optional<CaseRead> opened_case;
  std::optional<Document> demo;
  std::optional<Guide> guide;  ///< the first case's guide
  std::shared_ptr<const Volume> volume;
  std::shared_ptr<const Template> the_template;  ///< beside a case: the one that it saved; null where it saved none
  std::vector<LabelMapLayer> labels;             ///< the layers of the label map; none without one
  bool labels_off_image = false;                 ///< none of them lies in the image that they are shown over
  std::optional<Misfit> labels_misfit;           ///< then: what would bring their grid there
  std::vector<std::string> warnings;
  std::string fault;               ///< sentences on a case that was read in part; empty: it was read whole
  std::vector<SeriesInfo> series;  ///< the folder holds several and none was chosen: nothing was opened
  bool needs_spacing = false;      ///< a stack of pictures, whose voxel size was not told: nothing was opened
  std::string uneven;              ///< the fault of a series whose slices are no even stack: nothing was opened
};

/// Reads files beside the window, one request at a time. Called from the window's thread only.
class Opener {
 public:
  /// `wake` is called from the thread when it is done.
  explicit Opener(std::function<void()> wake) : worker_(std::move(wake)) {}

  /// Opens what is asked for, in place of what is being opened. `on_screen`: the image that a label map alone is shown
  /// over; null where there is none.
  void start(OpenRequest request, std::shared_ptr<const Volume> on_screen = nullptr);
  void cancel() { worker_.cancel(); }
  bool busy() const { return worker_.busy(); }
  /// The job that opens a file now; its subject is "ct.nii.gz".
  std::optional<RunningJob> running() const { return worker_.running(); }
  /// The opened files, or why they were not opened; once.
  std::optional<Result<Opened>> take() { return worker_.take(); }
  void finish() { worker_.finish(); }

 private:
  Worker<Opened> worker_;
};

}  // namespace homolog
