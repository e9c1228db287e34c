#include "core/session/same_document.h"

#include <algorithm>
#include <map>
#include <memory>
#include <tuple>

#include "core/base/same_values.h"
#include "core/case/members.h"

namespace homolog {

namespace {

using Shapes = std::map<int, std::shared_ptr<const Shape>>;
using Structures = std::vector<std::shared_ptr<const Structure>>;
using ContourSets = std::vector<std::shared_ptr<const ContourSet>>;

// Members of a document and of what it holds are compared by their types [members.h].

bool same(const auto& a, const auto& b) {
  return a == b;
}

template <class Array>
bool same(const std::shared_ptr<const Array>& a, const std::shared_ptr<const Array>& b) {
  return same_values(a, b);
}

bool same(const std::shared_ptr<const Volume>& a, const std::shared_ptr<const Volume>& b) {
  return a == b;
}

bool same(const std::shared_ptr<const Topology>& a, const std::shared_ptr<const Topology>& b) {
  return a == b || a->triangles() == b->triangles();
}

bool same(const std::shared_ptr<const Template>& a, const std::shared_ptr<const Template>& b) {
  const auto all = [&](const auto&... member) { return (same((*a).*member, (*b).*member) && ...); };
  return a == b || (a && b && std::apply(all, template_members));
}

bool same(const ContourSets& a, const ContourSets& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& x, const auto& y) { return x == y || *x == *y; });
}

bool same(const Shapes& a, const Shapes& b);
bool same(const Structures& a, const Structures& b);

template <Described Owner>
bool same(const Owner& a, const Owner& b) {
  return std::apply([&](const auto&... member) { return (same(a.*member.of, b.*member.of) && ...); }, members_of(a));
}

bool same(const Shapes& a, const Shapes& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
    const Shape &one = *x.second, &other = *y.second;
    return x.first == y.first && same(one, other) &&
           (one.reference == one.placed) == (other.reference == other.placed) &&
           (one.points == one.reference) == (other.points == other.reference);
  });
}

bool same(const Structures& a, const Structures& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& x, const auto& y) { return x == y || same(*x, *y); });
}

}  // namespace

bool same_document(const Document& a, const Document& b) {
  return same(a, b);
}

}  // namespace homolog
