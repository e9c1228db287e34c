#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "app/editor/work/worker.h"
#include "core/structures/fitting/fit_set.h"
#include "core/structures/repair/fit_repaired.h"

namespace homolog {

/// A label map that a set is fitted to, in one of its frames.
struct MapToFit {
  std::filesystem::path file;  ///< read anew, with all its layers
  int frame = 0;
  std::shared_ptr<const Volume> image;  ///< the scan, for a repair; may be null
  double gap_mm = 0;                    ///< the gap that is left between neighbours
};

/// How far a structure of the set is.
struct StructureFitShown {
  std::string name;
  SetFitStep step = SetFitStep::waits;
};

/// How far a fit of a set is, as a person sees it. A repair fits several times: to the map as it is, and to what it
/// proposes.
class SetFitRows {
 public:
  explicit SetFitRows(bool repair = false) : repair_(repair) {}
  void add(std::string name) { rows_.push_back({std::move(name)}); }
  /// A structure goes on, by its row. One that is done and is fitted anew begins another pass, in which all wait.
  void tell(std::size_t row, SetFitStep step);
  const std::vector<StructureFitShown>& rows() const { return rows_; }
  /// What is done at present: "Fitting the set".
  std::string pass() const;

 private:
  bool all_done() const;

  bool repair_ = false, again_ = false;
  std::vector<StructureFitShown> rows_;
};

/// The outcome of the fit of a set.
struct SetFitted {
  std::shared_ptr<const SetOfTemplates> set;
  SetInMap subject;
  FittedSet fitted;
  std::vector<std::string> warnings;  ///< the map's warnings
  /// One of each structure of the set where the map was repaired too, as RepairedFit has them; else both are empty.
  std::vector<std::string> found;
  std::vector<std::optional<Points>> as_read;
  std::vector<std::uint32_t> changes;  ///< the changes of voxels that the repair proposes [voxel_changes]
};

/// Fits a template set to a label map on a thread of its own. Called from the window's thread only.
class SetFitter {
 public:
  /// `wake` is called from other threads as structures go on.
  explicit SetFitter(std::function<void()> wake) : wake_(wake), work_(std::move(wake)) {}

  /// `case_number`: of the case that gets the structures.
  /// With `repair` it finds what is wrong with the map first, and fits to what it proposes.
  void start(std::shared_ptr<const SetOfTemplates> set, MapToFit map, bool repair, std::uint64_t case_number);
  void cancel() { work_.cancel(); }
  bool busy() const { return work_.busy(); }
  double fraction() const { return work_.fraction(); }
  std::uint64_t case_number() const { return case_number_; }
  int frame() const { return frame_; }
  /// The structures of the map that the set has, in the set's order; empty until the map is read.
  std::vector<StructureFitShown> structures() const;
  /// What is done at present [SetFitRows::pass].
  std::string pass() const;
  /// The result, once.
  std::optional<Result<SetFitted>> take() { return work_.take(); }
  void finish() { work_.finish(); }

 private:
  struct Shared {
    std::mutex mutex;
    std::vector<std::size_t> there;  ///< places in the set of the structures that the map has
    SetFitRows structures;
  };
  static Result<SetFitted> fit(std::shared_ptr<const SetOfTemplates> set, const MapToFit& map, bool repair,
                               Shared& shared, const std::function<void()>& wake, Progress& progress);
  std::function<void()> wake_;
  std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
  std::uint64_t case_number_ = 0;
  int frame_ = 0;
  Worker<SetFitted> work_;
};

}  // namespace homolog
