#include "core/template_making/distance_map.h"

#include <itkImage.h>
#include <itkSignedMaurerDistanceMapImageFilter.h>

#include <algorithm>
#include <cassert>

namespace homolog {

std::vector<float> distance_to(const std::vector<std::uint8_t>& set, const VolumeGeometry& grid) {
  assert(set.size() == grid.voxels());
  using Mask = itk::Image<std::uint8_t, 3>;
  using Map = itk::Image<float, 3>;
  const auto mask = Mask::New();
  mask->SetRegions(Mask::SizeType{static_cast<itk::SizeValueType>(grid.dims[0]),
                                  static_cast<itk::SizeValueType>(grid.dims[1]),
                                  static_cast<itk::SizeValueType>(grid.dims[2])});
  mask->SetSpacing(Mask::SpacingType(grid.spacing_mm.data()));
  mask->GetPixelContainer()->SetImportPointer(const_cast<std::uint8_t*>(set.data()), set.size());  // only read

  // On the calling thread alone: how many threads work is for core/base/processes/parallel.h to say.
  [[maybe_unused]] static const bool threader_chosen = [] {
    itk::MultiThreaderBase::SetGlobalDefaultThreader(itk::MultiThreaderBase::ThreaderType::Platform);
    return true;
  }();
  const auto filter = itk::SignedMaurerDistanceMapImageFilter<Mask, Map>::New();
  filter->SetNumberOfWorkUnits(1);
  filter->SetInput(mask);
  filter->SetSquaredDistance(false);
  filter->SetUseImageSpacing(true);
  filter->SetInsideIsPositive(false);
  filter->Update();

  const float* values = filter->GetOutput()->GetBufferPointer();
  std::vector<float> distance(values, values + set.size());
  for (float& d : distance) d = std::max(d, 0.0F);  // inside the set the filter measures to the set's rim
  return distance;
}

}  // namespace homolog
