#include "core/model/files/hdf5_reader.h"

// The program that the Python module starts to read an HDF5 file, since Python itself is none that could
// [core/base/processes/confined.h]. It does so before main().
int main() {
  return homolog::read_hdf5({}, {}) ? 0 : 1;
}
