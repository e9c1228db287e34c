#pragma once

#include <filesystem>

namespace homolog {

struct ContourRoi;
struct Editing;
struct Structure;

// Files that are read into the case on the screen, and templates that are written: beside the window, since they may be
// large or far away.

// Each that needs a template says so where the case has none.
void import_landmarks(Editing& editing, const std::filesystem::path& path);
void import_stiffness(Editing& editing, const std::filesystem::path& path);
void import_template_landmarks(Editing& editing, const std::filesystem::path& path);
/// Reads contours [OpenContours].
void import_contours(Editing& editing, const std::filesystem::path& path);
/// Adds one structure of a file to a structure of the case, as one edit. `joined`: undone together with the edit
/// before. False where the structure is locked, which is said.
bool add_contours(Editing& editing, const ContourRoi& roi, const Structure& structure, bool joined);
/// Reads a shape model for fits.
void open_fit_model(Editing& editing, const std::filesystem::path& path);
/// Reads the model that the shown mesh is scored against from then on.
void open_score_model(Editing& editing, const std::filesystem::path& path);

/// Writes the template as it is painted; from then on it is the case's, and that of the images that are opened next.
void save_template(Editing& editing, const std::filesystem::path& path);
/// Writes the template that was made, and starts anew with it where it was made.
void use_made_template(Editing& editing, const std::filesystem::path& path);
/// Shows the case's mesh again.
void close_template_making(Editing& editing);

}  // namespace homolog
