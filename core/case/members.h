#pragma once

#include <cstddef>
#include <tuple>

#include "core/case/document.h"

namespace homolog {

// The members of Shape and of Document, each named once. Equality, checkpoints, the count of memory and a new beginning
// are made from these lists. A new member does not compile until it is in its list.

/// Where the value of a member comes from.
enum class Origin {
  first_line,  ///< the first line of the case says it
  derived,     ///< it follows from the template and the placement
  set,         ///< actions set it; it stays where a shape begins anew
  begun,       ///< the placed template until edits move it
  edits        ///< empty until edits make it; empty again where a shape begins anew
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
    Member{"pulled", &Shape::pulled, Origin::edits}, Member{"pulls", &Shape::pulls, Origin::edits},
    Member{"unsnapped", &Shape::unsnapped, Origin::edits}, Member{"carried", &Shape::carried, Origin::edits},
    Member{"doubt", &Shape::doubt, Origin::edits}, Member{"doubt_mm", &Shape::doubt_mm, Origin::edits},
    Member{"outlier", &Shape::outlier, Origin::edits});

inline constexpr auto document_members = std::make_tuple(
    Member{"volume_source", &Document::volume_source, Origin::first_line},
    Member{"volume", &Document::volume, Origin::first_line}, Member{"template", &Document::the_template, Origin::set},
    Member{"shapes", &Document::shapes, Origin::set}, Member{"frame", &Document::frame, Origin::set},
    Member{"stiffness", &Document::stiffness, Origin::set}, Member{"regions", &Document::regions, Origin::set},
    Member{"stiffness_base", &Document::stiffness_base, Origin::set}, Member{"scheme", &Document::scheme, Origin::set},
    Member{"events", &Document::paper_events, Origin::set}, Member{"spacing", &Document::even_spacing, Origin::set},
    Member{"landmark_fit", &Document::landmark_pull, Origin::set},
    Member{"landmark_rule", &Document::landmark_rule, Origin::first_line},
    Member{"holds_landmarks", &Document::holds_landmarks, Origin::first_line});

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

static_assert(member_count::of<Shape>() == std::tuple_size_v<decltype(shape_members)>,
              "name the new member of Shape in shape_members");
static_assert(member_count::of<Document>() == std::tuple_size_v<decltype(document_members)>,
              "name the new member of Document in document_members");

}  // namespace homolog
