#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/case/actions/kept_structures.h"
#include "core/case/document.h"
#include "core/mesh/colours.h"
#include "core/structures/maps/case_segments.h"

namespace homolog {

/// How the window shows the structures of a case, and which of them are chosen in the list. All by their ids.
struct StructureLooks {
  std::set<std::string> hidden, locked;
  std::set<std::string> chosen;  ///< rows of the list that its eye and lock work on together
  std::string range_from;        ///< the row at which a choice with Shift begins
  std::string filter;            ///< part of a name, as it is typed
  bool worst_first = true;
  double others_opacity = 0.45;           ///< 0…1, in 3D, of structures that are not worked on
  std::map<std::string, double> opacity;  ///< 0…1, in 3D, of each by itself; 1 of those that are not in it
  /// The shapes that a repair changed: the shapes as the label map had them, n×3, LPS mm; null for one that was missing
  /// there.
  std::map<std::string, std::shared_ptr<const Points>> as_read;
  int as_read_frame = 0;      ///< the frame of the case that was repaired
  bool as_read_shown = true;  ///< beside what the repair proposes

  bool shows(const std::string& id) const { return !hidden.contains(id); }
  bool locks(const std::string& id) const { return locked.contains(id); }
  double opacity_of(const std::string& id) const {
    const auto own = opacity.find(id);
    return own == opacity.end() ? 1 : own->second;
  }
};

/// The looks of structures that a case keeps. `active`: the structure that is worked on.
KeptLooks kept_looks(const StructureLooks& looks, const std::string& active);
/// The looks that a case was left with, of the structures that there are.
StructureLooks looks_of_case(const KeptLooks* kept, const KeptMapFit* fit, const Document& document);
/// Takes over what a repair changed.
void take_as_read(StructureLooks& looks, const KeptMapFit& fit);
/// 0…1: the probability that a structure is rightly named, as the fit of a set or a person says; below 0: nobody said.
/// `fit`: null where there was none.
double name_confidence(const KeptMapFit* fit, const Structure& structure);

/// The shape of a structure before a repair; null where none is kept.
const Points* shape_as_read(const StructureLooks& looks, const Structure& structure);
/// Whether the structure has the shape again that it had before a repair, in the frame that was repaired.
bool is_taken_back(const StructureLooks& looks, const Structure& structure);
/// Its own colour, else the one of its name [colour_by_name].
Rgb structure_colour(const Structure& structure);
/// Whether somebody has to look at it: it is in doubt, or more likely wrong than right.
bool is_doubtful(const Structure& structure);
/// The same, but a person who took its repair back has looked at it.
bool is_to_be_seen(const StructureLooks& looks, const Structure& structure);
/// The first sentence for a person who wants to edit it although it is locked.
std::string locked_sentence(const Structure& structure);

/// The structures that go through a cine with the one that is worked on: all with a mesh that are not locked.
/// `active`: its id; empty: the first.
std::vector<std::string> carried_structures(const StructureLooks& looks, const Document& document,
                                            const std::string& active);

/// The structures that the list shows, in its order. Worst first: those in doubt, then by their confidence; those that
/// nobody judged, or whose repair was taken back, come last.
std::vector<const Structure*> listed_structures(const StructureLooks& looks, const Document& document);
/// Chooses rows by a click on one: it alone, with Ctrl it too (or no more), with Shift all from `range_from` on.
void choose_rows(StructureLooks& looks, const Document& document, const std::string& id, bool ctrl, bool shift);
/// The rows that an eye or a lock works on: all that are chosen where the row is one of several, else it alone.
std::vector<std::string> rows_with(const StructureLooks& looks, const std::string& id);
/// A new structure may get the id of one that is gone: it is seen, open and not chosen.
void begin_looks(StructureLooks& looks, const std::string& id);

}  // namespace homolog
