#pragma once

#include <cstddef>
#include <tuple>

#include "core/case/document.h"

namespace homolog {

// The members of a document and of what it holds, each named once. Equality, checkpoints, the count of memory and a new
// beginning are made from these lists. A new member does not compile until it is in its list.

/// The origin of a member's value.
enum class Origin {
  first_line,  ///< the first line of the case says it
  derived,     ///< it follows from the template and the placement
  set,         ///< a setting that one action gives its value; it stays where a shape begins anew
  begun,       ///< the placed template until edits move it
  edits  ///< a trace of edits of this mesh, empty until they leave it; empty again where a shape begins anew or is
         ///< copied to another frame
};

template <class Owner, class Value>
struct Member {
  const char* key;  ///< in a checkpoint
  Value Owner::*of;
  Origin origin;

  /// Whether a checkpoint holds it.
  constexpr bool kept() const { return origin != Origin::first_line && origin != Origin::derived; }
};

template <class Owner, class Value>
Member(const char*, Value Owner::*, Origin) -> Member<Owner, Value>;

inline constexpr auto shape_members = std::make_tuple(
    Member{"placement", &Shape::placement, Origin::set},
    Member{"before_landmarks", &Shape::before_landmarks, Origin::set},
    Member{"landmarks", &Shape::landmarks, Origin::set}, Member{"placed", &Shape::placed, Origin::derived},
    Member{"reference", &Shape::reference, Origin::begun}, Member{"points", &Shape::points, Origin::begun},
    Member{"confirmed", &Shape::confirmed, Origin::set}, Member{"decided", &Shape::decided, Origin::edits},
    Member{"unaided", &Shape::unaided, Origin::edits}, Member{"strokes", &Shape::strokes, Origin::edits},
    Member{"drawn_strokes", &Shape::drawn_strokes, Origin::edits}, Member{"pulled", &Shape::pulled, Origin::edits},
    Member{"pulls", &Shape::pulls, Origin::edits}, Member{"unsnapped", &Shape::unsnapped, Origin::edits},
    Member{"carried", &Shape::carried, Origin::edits}, Member{"doubt", &Shape::doubt, Origin::edits},
    Member{"doubt_mm", &Shape::doubt_mm, Origin::edits}, Member{"outlier", &Shape::outlier, Origin::edits});

inline constexpr auto paint_members = std::make_tuple(Member{"stiffness", &Paint::stiffness, Origin::set},
                                                      Member{"regions", &Paint::regions, Origin::set},
                                                      Member{"stiffness_base", &Paint::base, Origin::set});

inline constexpr auto landmark_rules_members = std::make_tuple(Member{"pull", &LandmarkRules::pull, Origin::set},
                                                               Member{"rule", &LandmarkRules::rule, Origin::set},
                                                               Member{"hold", &LandmarkRules::hold, Origin::set});

inline constexpr auto structure_members = std::make_tuple(
    Member{"id", &Structure::id, Origin::set}, Member{"name", &Structure::name, Origin::set},
    Member{"label", &Structure::label, Origin::set}, Member{"layer", &Structure::layer, Origin::set},
    Member{"colour", &Structure::colour, Origin::set}, Member{"side", &Structure::side, Origin::set},
    Member{"partner", &Structure::partner, Origin::set}, Member{"template", &Structure::the_template, Origin::set},
    Member{"paint", &Structure::paint, Origin::set}, Member{"shapes", &Structure::shapes, Origin::set},
    Member{"landmarks", &Structure::landmarks, Origin::set}, Member{"confidence", &Structure::confidence, Origin::set},
    Member{"doubt", &Structure::doubt, Origin::set}, Member{"contours", &Structure::contours, Origin::set},
    Member{"shared", &Structure::shared, Origin::set});

inline constexpr auto scan_members = std::make_tuple(Member{"source", &Scan::source, Origin::first_line},
                                                     Member{"image", &Scan::image, Origin::first_line});

inline constexpr auto document_members = std::make_tuple(
    Member{"scan", &Document::scan, Origin::first_line}, Member{"structures", &Document::structures, Origin::set},
    Member{"frame", &Document::frame, Origin::set}, Member{"scheme", &Document::scheme, Origin::set},
    Member{"events", &Document::paper_events, Origin::set}, Member{"spacing", &Document::even_spacing, Origin::set});

/// The members of a template, for equality alone: a checkpoint holds what the case changed of it.
inline constexpr auto template_members = std::make_tuple(
    &Template::source, &Template::topology, &Template::points, &Template::stiffness, &Template::stiffness_base,
    &Template::regions, &Template::landmarks, &Template::landmark_points, &Template::missing_share, &Template::faced);

/// Calls `visit(member)` for each member of a list, in its order.
template <class List, class Visit>
constexpr void for_each_member(const List& list, const Visit& visit) {
  std::apply([&](const auto&... member) { (visit(member), ...); }, list);
}

namespace member_count {

struct Anything {
  template <class T>
  operator T() const;  // NOLINT(google-explicit-constructor): it stands for a value of any member
};

/// How many members an aggregate has: with how many values it can be made.
template <class T, class... Known>
consteval std::size_t of() {
  if constexpr (requires { T{Known{}..., Anything{}}; })
    return of<T, Known..., Anything>();
  else
    return sizeof...(Known);
}

}  // namespace member_count

template <class Owner, class List>
constexpr bool names_all(const List&) {
  return member_count::of<Owner>() == std::tuple_size_v<List>;
}
static_assert(names_all<Shape>(shape_members), "name the new member of Shape in shape_members");
static_assert(names_all<Paint>(paint_members), "name the new member of Paint in paint_members");
static_assert(names_all<LandmarkRules>(landmark_rules_members), "name the new member in landmark_rules_members");
static_assert(names_all<Structure>(structure_members), "name the new member of Structure in structure_members");
static_assert(names_all<Scan>(scan_members), "name the new member of Scan in scan_members");
static_assert(names_all<Template>(template_members), "name the new member of Template in template_members");
static_assert(names_all<Document>(document_members), "name the new member of Document in document_members");

// The list of an object's members, by its type.

constexpr const auto& members_of(const Shape&) {
  return shape_members;
}
constexpr const auto& members_of(const Paint&) {
  return paint_members;
}
constexpr const auto& members_of(const LandmarkRules&) {
  return landmark_rules_members;
}
constexpr const auto& members_of(const Structure&) {
  return structure_members;
}
constexpr const auto& members_of(const Scan&) {
  return scan_members;
}
constexpr const auto& members_of(const Document&) {
  return document_members;
}

/// A value whose members are listed here.
template <class T>
concept Described = requires(const T& value) {
  members_of(value);
};

}  // namespace homolog
