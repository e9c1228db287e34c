#pragma once

#include <string>
#include <vector>

namespace homolog {

class ShownCase;
struct Editing;
struct EditorState;
struct ShownLabels;
struct TemplateSet;
struct Work;

// The fit of a template set to the label map that is shown.

/// Reads a set beside the window; it is the chosen one from then on.
void choose_set(Editing& editing, const std::string& source);
/// Begins the fit of the chosen set; with `repair`, to what the repair of the map proposes. Says why where that cannot
/// be.
void start_set_fit(Editing& editing, bool repair);
/// Takes in what a fit of a set found; gives it up where another case or frame is shown meanwhile. True where there is
/// something new to draw.
bool update_set_fit(Editing& editing);

/// Why the set cannot be fitted now; empty where it can.
std::string set_fit_refusal(const EditorState& state, const ShownCase& shown, const Work& work);

/// The structures of a set that the label map has, by their names or else by their values.
std::vector<std::string> names_in_map(const TemplateSet& set, const ShownLabels& labels);

}  // namespace homolog
