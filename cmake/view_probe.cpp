// Crashes where g++ 12 miscompiles the reference count of a Kokkos::View; see kokkos.cmake.
#include <Kokkos_Core.hpp>

struct Holder {
  Kokkos::View<double*, Kokkos::HostSpace> view;
};

int main()
{
  Kokkos::initialize();
  bool good = true;
  {
    Holder empty, other;
    good = empty.view.use_count() == 0 && empty.view.label().empty();
    other = empty;
    other.view = Kokkos::View<double*, Kokkos::HostSpace>("probe", 3);
    empty = other;
    good = good && empty.view.use_count() == 2 && empty.view.label() == "probe";
    Kokkos::resize(empty.view, 5);
    Holder moved = static_cast<Holder&&>(empty);
    good = good && moved.view.extent(0) == 5;
  }
  Kokkos::finalize();
  return good ? 0 : 1;
}
