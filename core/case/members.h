#pragma once

#include <tuple>

#include "core/base/member_list.h"
#include "core/case/document.h"

namespace homolog {

// The members of a document and of what it holds, each named once. Equality, checkpoints, the count of memory and a new
// beginning are made from these lists. A new member does not compile until it is in its list.

/// The origin of a member's value. Those from `edits` on are traces of edits of this mesh: empty until edits leave
/// them, and empty again where a shape begins anew or is copied to another frame. Some of them are emptied earlier.
enum class Origin {
  first_line,  ///< the first line of the case says it
  derived,     ///< it follows from the template and the placement
  set,         ///< a setting that one action gives its value; it stays where a shape begins anew
  begun,       ///< the placed template until edits move it
  edits,       ///< a trace that stays until the shape begins anew
  since_fit,   ///< a trace of what was done since the last fit: the next fit empties it
  fit,         ///< what the last fit said of the vertices' places: the next one, and a new placement, empty it
  step         ///< what the last automatic step said: the next one empties it
};

/// Whether a value is a trace of edits.
constexpr bool is_trace(Origin origin) {
  return origin >= Origin::edits;
}

/// Whether a trace that holds points moves along with a new placement.
constexpr bool moves_along(Origin origin) {
  return origin == Origin::edits || origin == Origin::since_fit;
}

template <class Owner, class Value>
struct Member {
  const char* key;  ///< its key in a checkpoint
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
    Member{"drawn_strokes", &Shape::drawn_strokes, Origin::edits}, Member{"pulled", &Shape::pulled, Origin::since_fit},
    Member{"pulls", &Shape::pulls, Origin::since_fit}, Member{"unsnapped", &Shape::unsnapped, Origin::since_fit},
    Member{"carried", &Shape::carried, Origin::step}, Member{"doubt", &Shape::doubt, Origin::step},
    Member{"doubt_mm", &Shape::doubt_mm, Origin::fit}, Member{"outlier", &Shape::outlier, Origin::fit});

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

static_assert(names_all<Shape>(shape_members), "name each member of Shape once in shape_members");
static_assert(names_all<Paint>(paint_members), "name each member of Paint once in paint_members");
static_assert(names_all<LandmarkRules>(landmark_rules_members), "name each member once in landmark_rules_members");
static_assert(names_all<Structure>(structure_members), "name each member of Structure once in structure_members");
static_assert(names_all<Scan>(scan_members), "name each member of Scan once in scan_members");
static_assert(names_all<Template>(template_members), "name each member of Template once in template_members");
static_assert(names_all<Document>(document_members), "name each member of Document once in document_members");

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
