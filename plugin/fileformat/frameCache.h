// The slid frames of all open layers: bounded by bytes, each slid once however many threads ask for it.
#ifndef SKINSLIDE_FORMAT_FRAME_CACHE_H
#define SKINSLIDE_FORMAT_FRAME_CACHE_H

#include "pxr/pxr.h"

#include "pxr/base/gf/vec3f.h"
#include "pxr/base/vt/array.h"
#include "pxr/base/vt/types.h"
#include "pxr/base/vt/value.h"

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

namespace skinslide {
using namespace PXR_NS;

struct Frame {
    VtValue points;      // slid, or the cache's own
    VtVec3fArray cached; // before sliding; empty where the frame could not be solved
    VtVec3fArray turns;  // how the skin turned under each point, where anything depends on it
    size_t bytes = 0;    // that are kept for it alone
};

class FrameCache {
  public:
    // The process's: so many open layers share one bound, SKINSLIDE_CACHE_MB, 512 where it is not set.
    static FrameCache &shared();

    explicit FrameCache(size_t capacityInBytes) : _capacity(capacityInBytes) {
    }

    // The frame of an owner at a time, made by the first thread that asks; others wait for that one only.
    std::shared_ptr<const Frame> get(const void *owner, double time, const std::function<Frame()> &make);
    // Forgets the frames of an owner, which nobody asks for any more.
    void drop(const void *owner);
    size_t bytes() const;

  private:
    using Key = std::pair<const void *, uint64_t>;
    struct Entry {
        std::shared_ptr<const Frame> frame; // null while it is being made
        size_t bytes = 0;
        std::list<Key>::iterator used;
    };
    void keep(const Key &key, std::shared_ptr<const Frame> frame);
    void evict();

    const size_t _capacity;
    mutable std::mutex _mutex;
    std::condition_variable _made;
    std::map<Key, Entry> _entries;
    std::list<Key> _order; // least recently used first; without those being made
    size_t _bytes = 0;
};

} // namespace skinslide

#endif
