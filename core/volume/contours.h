#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/numbers/geometry.h"
#include "core/base/result.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// A polygon, or an open line, through points in LPS mm.
struct Contour {
  std::vector<Vec3> points;  ///< the last is joined to the first where it is closed, and is not the first again
  bool closed = true;
  bool cuts_out = false;  ///< combined with the others of its plane by exclusive or (CLOSEDPLANAR_XOR)
  std::string image{};    ///< the only image that it was drawn on [named_image]; empty: not said

  /// The same line, whatever image it names.
  bool operator==(const Contour& other) const {
    return points == other.points && closed == other.closed && cuts_out == other.cuts_out;
  }
};

/// One region of interest: a structure as someone drew it, plane by plane.
struct ContourRoi {
  std::string name;
  int number = 0;
  std::string type;  ///< "ORGAN", "PTV", …; empty where unknown
  std::optional<std::array<std::uint8_t, 3>> colour{};
  std::vector<Contour> contours{};
  std::vector<Vec3> points{};  ///< marked places, LPS mm
  /// Things that were not taken as they stand in the file, each the end of a sentence about the structure: "… twice;
  /// …".
  std::vector<std::string> doubts{};

  /// How many points its contours and marked places have in all.
  std::size_t all_points() const;
  /// On how many planes its closed contours lie.
  std::size_t planes() const;
  /// How far neighbours of these lie apart: the median. Nothing where there is one, or where they are not parallel.
  std::optional<double> planes_apart_mm() const;
};

/// The contours of a file (DICOM RTSTRUCT).
struct Contours {
  std::vector<ContourRoi> rois;    ///< in the order of their numbers
  std::string frame_of_reference;  ///< UID of the space of all points
  ReferencedImages referenced;     ///< the images that they were drawn on
  std::vector<std::string> warnings;
};

/// The centre of a closed contour and the unit normal of its plane [Newell]; a zero normal where its points lie on a
/// line.
std::pair<Vec3, Vec3> plane_of(const Contour& contour);

/// Whether two contours are one line: the same points, also in the other direction, and where they are closed from
/// another point on.
bool is_same_line(const Contour& a, const Contour& b);

/// Whether a polygon crosses itself, with edges that meet between their ends; edges that lie on one another, as in a
/// keyhole, do not.
bool crosses_itself(const Contour& contour);

/// Whether a file is a DICOM structure set.
bool holds_contours(const std::filesystem::path& path);

/// Reads a structure set [DICOM PS3.3, A.19, C.8.8.5 and C.8.8.6]. A contour that is there twice, in either direction
/// [is_same_line], is read once.
/// `warnings`: what doubts_about says. Errors: no structure set; contours of a structure that is not described; points
/// that are missing or no numbers; no frame of reference, or several.
Result<Contours> read_contours(const std::filesystem::path& path);

/// Warnings about structures before anything is made of them: those without points, contours that cross
/// themselves, and `ContourRoi::doubts`.
std::vector<std::string> doubts_about(const std::filesystem::path& path, const std::vector<ContourRoi>& rois);

/// The structure of a name, in any case, or of a number. Errors: none, or several of the name; those that there are
/// are named.
Result<const ContourRoi*> roi_of(const Contours& contours, const std::string& asked);

}  // namespace homolog
