#include "core/session/history.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <concepts>
#include <type_traits>
#include <unordered_set>

#include "core/case/members.h"

namespace homolog {

namespace {

// Calls `visit(address, bytes)` for an array that is as long as the mesh. A member of a new type does not compile until
// it is said here what it holds.

template <class Value>
concept HoldsNoArray = std::is_arithmetic_v<Value> || std::is_enum_v<Value> || std::same_as<Value, std::string> ||
    std::same_as<Value, std::optional<std::string>> || std::same_as<Value, decltype(Structure::colour)> ||
    std::same_as<Value, Similarity> || std::same_as<Value, decltype(Shape::landmarks)>;

void visit_array(const HoldsNoArray auto&, const auto&) {}

template <class Array>
concept OfVertices = std::same_as<Array, Points> || std::same_as<Array, VertexScalars>;

template <OfVertices Array>
void visit_array(const std::shared_ptr<const Array>& array, const auto& visit) {
  if (array) visit(static_cast<const void*>(array.get()), static_cast<std::size_t>(array->size()) * sizeof(double));
}

void visit_array(const std::shared_ptr<const Volume>&, const auto&) {}  // all states share it

void visit_array(const std::shared_ptr<const Regions>& regions, const auto& visit) {
  if (regions) visit(static_cast<const void*>(regions.get()), regions->of_vertex.size());
}

void visit_array(const std::shared_ptr<const Template>& the_template, const auto& visit) {
  if (!the_template) return;
  visit(static_cast<const void*>(the_template.get()),
        static_cast<std::size_t>(the_template->points.size() + the_template->stiffness.size()) * sizeof(double));
  constexpr std::size_t a_vertex = 200;  // bytes of a topology's tables
  visit(static_cast<const void*>(the_template->topology.get()),
        a_vertex * static_cast<std::size_t>(the_template->topology->vertices()));
}

void visit_array(const std::vector<std::shared_ptr<const ContourSet>>& contours, const auto& visit) {
  for (const auto& set : contours) {
    std::size_t points = 0;
    for (const Contour& curve : set->curves) points += curve.points.size();
    visit(static_cast<const void*>(set.get()), points * sizeof(Vec3));
  }
}

void visit_array(const std::vector<SharedWith>& shared, const auto& visit) {
  for (const SharedWith& one : shared)
    visit(static_cast<const void*>(one.vertices.get()), one.vertices->size() * sizeof(VertexPair));
}

template <Described Owner>
void visit_array(const Owner& owner, const auto& visit);

template <Described Owner>
void visit_array(const std::shared_ptr<const Owner>& owner, const auto& visit) {
  visit_array(*owner, visit);
}

void visit_array(const std::map<int, std::shared_ptr<const Shape>>& shapes, const auto& visit) {
  for (const auto& [frame, shape] : shapes) visit_array(*shape, visit);
}

void visit_array(const std::vector<std::shared_ptr<const Structure>>& structures, const auto& visit) {
  for (const auto& structure : structures) visit_array(*structure, visit);
}

template <Described Owner>
void visit_array(const Owner& owner, const auto& visit) {
  for_each_member(members_of(owner), [&](const auto& member) { visit_array(owner.*member.of, visit); });
}

/// The bytes of a document that another one does not hold already.
std::size_t bytes_beside(const Document& document, const Document& other) {
  std::unordered_set<const void*> known;
  visit_array(other, [&](const void* array, std::size_t) { known.insert(array); });
  std::size_t sum = 0;
  visit_array(document, [&](const void* array, std::size_t bytes) {
    if (known.insert(array).second) sum += bytes;  // an array may serve twice
  });
  return sum;
}

}  // namespace

History::History(std::shared_ptr<const Document> start, std::size_t most_bytes)
    : start_(std::move(start)), most_bytes_(most_bytes) {}

std::optional<History::Way> History::undo(std::size_t from) const {
  std::size_t k = from;
  while (k > 0 && steps_[k - 1].look) --k;
  if (k == 0) return std::nullopt;
  const std::size_t last = --k;
  while (k > 0 && steps_[k].joined) --k;
  return Way{k, k, last};
}

std::optional<History::Way> History::redo(std::size_t from) const {
  std::size_t k = from;
  while (k < size() && steps_[k].look) ++k;
  if (k == size()) return std::nullopt;
  const std::size_t first = k++;
  while (k < size() && steps_[k].joined) ++k;
  return Way{k, first, k - 1};
}

void History::reserve(std::size_t more) {
  if (current_ + more > steps_.capacity()) steps_.reserve(std::max(current_ + more, 2 * steps_.capacity()));
}

void History::push(Step step) {
  assert(steps_.capacity() > current_);
  steps_.resize(current_);
  if (step.joined && !steps_.empty()) steps_.back().after.reset();  // nobody can come to rest between the two
  steps_.push_back(std::move(step));
  ++current_;
}

void History::keep(std::size_t state, std::shared_ptr<const Document> document) {
  if (state == 0) return;
  steps_[state - 1].after = std::move(document);
  // The looks before it came with states of their own.
  std::size_t first = state;
  while (first > 1 && steps_[first - 2].look) --first;
  for (std::size_t added = first; added <= state; ++added)
    if (kept(added)) bytes_at_most_ += bytes_beside(*kept(added), *kept(nearest_before(added)));
  if (bytes_at_most_ > most_bytes_) thin_out();
}

std::size_t History::nearest_before(std::size_t state) const {
  do --state;
  while (!kept(state));
  return state;
}

std::size_t History::bytes() const {
  std::size_t sum = 0;
  const Document* before = start_.get();
  for (const Step& step : steps_) {
    if (!step.after) continue;
    sum += bytes_beside(*step.after, *before);
    before = step.after.get();
  }
  return sum;
}

void History::thin_out() {
  constexpr std::size_t near = 32;
  const auto thin = [this](std::size_t around) {
    for (std::size_t state = 1; state <= size(); ++state) {
      const std::size_t away = state > current_ ? state - current_ : current_ - state;
      if (away > around && state % stride_ != 0) steps_[state - 1].after.reset();
    }
    bytes_at_most_ = bytes();
    return bytes_at_most_ <= most_bytes_ / 4 * 3;  // so that it is not done again at once
  };
  bool fits = thin(near);
  for (; !fits && stride_ < size(); fits = thin(near)) stride_ *= 2;
  for (std::size_t around = near; !fits && around > 0; fits = thin(around)) around /= 2;
}

}  // namespace homolog
