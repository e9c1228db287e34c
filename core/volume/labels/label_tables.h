#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/volume/labels/segmentation.h"
#include "core/volume/volume_io.h"

namespace homolog {

// Names of labels as other programs keep them beside their label maps. The readers are in labels_in_*.cpp.

/// JSON: {"1": "spleen"}, {"spleen": 1}, either as the member "labels" of an object (nnU-Net), or a list of objects
/// with `value` (or `label`, `id`), `name` and perhaps `colour` "#rrggbb". No segments where it is about something
/// else. Errors: no JSON; a label that has two names.
Result<Segmentation> labels_of_json(std::string_view text);

/// Lines of a number, a name and a colour: ITK-SNAP's label descriptions (R G B A, flags, "name"), FreeSurfer's colour
/// table and 3D Slicer's (name, R G B A), a number and a name. No segments where no line is one of these. Errors: a
/// line that is none, a label that has two names; they say the line.
Result<Segmentation> labels_of_lines(std::string_view text);

/// A table with commas, semicolons or tabs. Its first line names the columns: a value (`value`, `label`, `index`, `id`,
/// `LabelValue`), a name (`name`, `structure`, `label_name`), perhaps a colour (`colour`, or red, green and blue); or
/// it has two columns, a value and a name. No segments where it is about something else. Errors: as above.
Result<Segmentation> labels_of_table(std::string_view text);

/// The label table in XML that Caret, Connectome Workbench and TotalSegmentator put into a NIfTI header.
Segmentation labels_of_xml(std::string_view text);

/// Gives a label map without names those of a file beside it, where there is one: of the map's name (ct_seg.json, .csv,
/// .tsv, .label, .txt, .ctbl), or of the folder (labels.json, dataset.json, FreeSurferColorLUT.txt, …). An image stays
/// as it is. Warnings name a file that holds names and cannot be followed.
void take_names_beside(const std::filesystem::path& path, VolumeRead& read);
/// The file beside a label map that names are taken from, should it be a label map; empty where there is none.
std::filesystem::path label_names_beside(const std::filesystem::path& path);

}  // namespace homolog
