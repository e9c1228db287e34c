#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/editor/work/worker.h"
#include "core/assist/cine.h"

namespace homolog {

/// The edit that a propagation makes of each structure, by its id.
using StructureCines = std::vector<std::pair<std::string, CineEdit>>;

/// Carries the meshes of a case's structures through its cine, on a thread of its own. Called from the window's thread
/// only.
class Propagator {
 public:
  /// `wake` is called from the thread when it is done.
  explicit Propagator(std::function<void()> wake) : work_(std::move(wake)) {}

  /// `of`: the structures, by their ids; an empty one is the first.
  void start(std::shared_ptr<const Document> document, std::vector<std::string> of = {{}});
  void cancel();
  bool busy() const { return work_.busy(); }
  double fraction() const { return work_.fraction(); }
  /// The case as it was at the start; null where nothing goes on.
  const std::shared_ptr<const Document>& document() const { return document_; }
  /// Whether a case still has the meshes that the work started from; to look at other frames changes nothing.
  bool still_of(const Document& now) const;
  /// The result, once.
  std::optional<Result<StructureCines>> take();
  void finish() { work_.finish(); }

 private:
  std::shared_ptr<const Document> document_;
  std::vector<std::string> of_;
  Worker<StructureCines> work_;
};

}  // namespace homolog
