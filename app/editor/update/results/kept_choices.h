#pragma once

namespace homolog {

struct Editing;
struct KeptLooks;

/// Reads the template set, the recipe and the model again that the case on the screen was left with, beside the window.
/// What the case does not say stays as it is. A file that is gone is passed over; of one that cannot be read a notice
/// says so.
void bring_back_choices(Editing& editing, const KeptLooks& kept);

}  // namespace homolog
