#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace homolog {

struct Editing;

// The study as a worklist: scans become cases, those that wait are fitted, and what a person spends on each is counted.

/// Makes cases for scans, with the study's template, else that of the case on the screen. One path stands for its
/// folder, several stand for themselves.
void add_scans(Editing& editing, const std::vector<std::filesystem::path>& paths);
/// Fits every case that waits to its label map: to that label, or to all together. Without one it is asked for as soon
/// as a map holds several.
void fit_waiting(Editing& editing, int label, bool all_labels);
/// Makes a consensus template of the label maps of the study's cases, of that label or of all together. It becomes the
/// study's template, and the cases that wait begin with it.
void make_study_template(Editing& editing, const std::filesystem::path& file, int label, bool all_labels);
void cancel_worklist(Editing& editing);
/// Takes in what the worklist did; true where there is something new to draw.
bool take_worklist(Editing& editing);

/// The case on the screen is done, where it is one of the study's; the next one is opened.
void open_next_case(Editing& editing);
/// Adds to the study's case what was done on it since the last call: edits, and the time between events that follow
/// each other within half a minute. `steps_before`: what the snapshot had counted then. `seconds`: the window's
/// clock.
void count_work(Editing& editing, std::uint64_t steps_before, double seconds);

}  // namespace homolog
