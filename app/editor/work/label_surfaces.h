#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/editor/state/settings.h"
#include "app/editor/work/worker.h"
#include "core/case/document.h"
#include "core/mesh/topology.h"

namespace homolog {

/// The label of a map that a fit would go to: the one that was chosen, else the one that the mesh lies in, else the
/// first; every_label where all are taken together. `known`: the labels of the map; 0 where there are none.
int label_in_hand(const FitSettings& settings, const std::vector<int>& known, const Volume& labels,
                  const std::optional<ShapeView>& shown);

/// Smooth surfaces of labels, made beside the window when they are wanted, and kept for their label map. Called from
/// the window's thread only.
class LabelSurfaces {
 public:
  struct Wanted {
    std::shared_ptr<const Volume> labels;
    int label = 0, frame = 0;
    bool operator==(const Wanted&) const = default;
  };
  /// `wake` is called from the thread when one is made.
  explicit LabelSurfaces(std::function<void()> wake) : worker_(std::move(wake)) {}

  /// From now on this one is wanted, or none: what is made for another one is given up.
  void want(std::optional<Wanted> wanted);
  /// Takes in what was made; true where there is something new to draw.
  bool update();
  /// The surface that is wanted; null while it is made, and where the frame lacks the label.
  std::shared_ptr<const Mesh> shown() const;
  int label() const { return wanted_ ? wanted_->label : 0; }
  bool busy() const { return worker_.busy(); }
  std::optional<RunningJob> running() const { return worker_.running(); }

 private:
  struct Made {
    Wanted of;
    std::shared_ptr<const Mesh> mesh;  ///< null where there is none
  };
  const Made* found(const Wanted& wanted) const;

  std::optional<Wanted> wanted_;
  std::deque<Made> made_;  ///< the latest last
  Worker<Made> worker_;
};

}  // namespace homolog
