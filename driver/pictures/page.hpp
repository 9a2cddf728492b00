// A page for a browser that plays frames: one file with everything in it.
#pragma once

#include "output_file.hpp"
#include "pictures/look.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace ricochet::driver {

/// The page as it is in page.html, with two places to fill: <!--frames--> and <!--header-->.
extern char const* const page_text;

/// A page on its way to a file.
class Page {
 public:
  /// `fps`: frames a second at its usual speed. Throws Failure.
  Page(std::string const& path, Stage const& stage, Look const& look, double fps, bool replace);
  ~Page();
  Page(Page const&) = delete;
  Page& operator=(Page const&) = delete;

  /// Appends a frame. Throws Failure.
  void add(double time, std::vector<DiscState> const& discs);

  /// Puts the page in its place. Throws Failure.
  void finish();

 private:
  class Packer;

  void write_frame(std::vector<DiscState> const& discs);
  std::string header() const;

  Stage stage_;
  Look look_;
  double fps_;
  OutputFile file_;
  std::unique_ptr<Packer> packer_;
  Region range_;   ///< of the places
  double fastest_; ///< end of the range of the speeds
  std::vector<double> times_, kinetic_, potential_, total_;
  std::vector<std::uint16_t> before_, before_that_; ///< x, y and speed of all discs
};

} // namespace ricochet::driver
