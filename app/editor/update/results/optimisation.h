#pragma once

namespace homolog {

struct Editing;

/// Starts sliding the vertices of the study's shapes along their surfaces; does nothing where that cannot be done.
void start_optimisation(Editing& editing);
/// Takes in the rounds and the result, and stops it where its study is not the one in hand any more. True where there
/// is something new to draw.
bool update_optimisation(Editing& editing);

}  // namespace homolog
