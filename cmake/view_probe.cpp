// Crashes where g++ 12 miscompiles the reference count of a Kokkos::View; see kokkos.cmake.
// Nothing is allocated, so Kokkos need not be initialised and no GPU need be there.
#include <Kokkos_Core.hpp>

#include <utility>

struct Holder {
  Kokkos::View<double*, Kokkos::HostSpace> view;
};

int main()
{
  Holder empty, other;
  bool good = empty.view.use_count() == 0 && empty.view.label().empty();
  other = empty;
  Holder moved = std::move(empty);
  moved = Holder();
  return good && other.view.use_count() == 0 && moved.view.label().empty() ? 0 : 1;
}
