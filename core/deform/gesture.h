#pragma once

namespace homolog {

/// What a drag does; method and limits in docs/editing.md.
enum class Tool {
  pull,   ///< the surface to the cursor along its normal [Erdt 2009, §2.2, Fig. 2c]
  grab,   ///< a feature with its landmarks, normal and lateral
  slide,  ///< landmarks along the surface, which stays
  relax   ///< back towards the reference's local shape, under the brush
};



}  // namespace homolog
