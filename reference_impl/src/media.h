// Which media a ray is in, under the rules `nested_media` and `media_counted`: the objects that it entered and has not left, innermost
// last.
#pragma once

#include <vector>

#include "world.h"

namespace equilux {

// A ray's place in a Media, and how many rays of its path count towards the recursion limit: what a changed rule has to know of a path.
struct Journey {
  int medium = -1;
  int counted = 0;
};

// Whether entering the object leads into another medium: closed shapes and planes, and meshes whose index is not 1 (those are closed, too;
// a mesh of index 1 need not be, and is passed straight).
bool is_medium(const World& world, int object);

// The index inside an object. Whoever counts crossings knows no outward side: under `media_counted` the inside of a mesh wound inwards has
// the inverse index.
double index_inside(const World& world, int object);

// The stacks of all rays of a sample, which share their lower parts. A stack is the number of its innermost entry, −1: outside of all.
class Media {
 public:
  void clear() { entries_.clear(); }

  // The index of the innermost one, 1 outside of all.
  double index(const World& world, int stack) const;
  bool contains(int stack, int object) const;
  double index_without(const World& world, int stack, int object) const;  // of the innermost other than the object
  int entered(int stack, int object);
  int left(int stack, int object);  // the object's innermost entry is taken out, if there is one
  // The media in which the eye's own rays start: planes, spheres, boxes and cylinders around their origin (eye-relative), the largest
  // outermost. Meshes are not looked at.
  int around(const World& world, const Vec3dd& origin);

 private:
  struct Entry {
    int object, below;
  };
  std::vector<Entry> entries_;
};

}  // namespace equilux
