#include "frameCache.h"

#include "environment.h"
#include "fault.h"

#include "pxr/base/tf/diagnostic.h"

#include <cstring>

namespace skinslide {
namespace {

uint64_t bitsOf(double time) {
    uint64_t bits = 0;
    std::memcpy(&bits, &time, sizeof bits);
    return bits;
}

size_t capacityInBytes() {
    const int fallback = 512;
    int megabytes = fallback;
    try {
        megabytes = countFromEnvironment("SKINSLIDE_CACHE_MB", fallback);
    } catch (const Fault &bad) {
        TF_WARN("%s; it counts as %d", bad.what(), fallback);
    }
    return static_cast<size_t>(megabytes) << 20;
}

} // namespace

FrameCache &FrameCache::shared() {
    // Never destroyed: layers may be closed after the statics of this library are gone.
    static FrameCache *cache = new FrameCache(capacityInBytes());
    return *cache;
}

std::shared_ptr<const Frame> FrameCache::get(const void *owner, double time, const std::function<Frame()> &make) {
    Key key(owner, bitsOf(time));
    std::unique_lock<std::mutex> lock(_mutex);
    for (auto found = _entries.find(key); found != _entries.end(); found = _entries.find(key)) {
        if (found->second.frame) {
            _order.splice(_order.end(), _order, found->second.used);
            return found->second.frame;
        }
        _made.wait(lock);
    }
    _entries[key]; // announces it
    lock.unlock();
    std::shared_ptr<const Frame> frame;
    try {
        frame = std::make_shared<const Frame>(make());
    } catch (...) {
        lock.lock();
        _entries.erase(key);
        _made.notify_all();
        throw;
    }
    lock.lock();
    keep(key, frame);
    _made.notify_all();
    return frame;
}

void FrameCache::keep(const Key &key, std::shared_ptr<const Frame> frame) {
    Entry &entry = _entries[key];
    entry.bytes = sizeof *frame + frame->bytes;
    entry.frame = std::move(frame);
    entry.used = _order.insert(_order.end(), key);
    _bytes += entry.bytes;
    evict();
}

void FrameCache::evict() {
    while (_bytes > _capacity && !_order.empty()) {
        auto oldest = _entries.find(_order.front());
        _bytes -= oldest->second.bytes;
        _entries.erase(oldest);
        _order.pop_front();
    }
}

void FrameCache::drop(const void *owner) {
    std::lock_guard<std::mutex> lock(_mutex);
    for (auto it = _entries.lower_bound(Key(owner, 0)); it != _entries.end() && it->first.first == owner;) {
        _bytes -= it->second.bytes;
        _order.erase(it->second.used);
        it = _entries.erase(it);
    }
}

size_t FrameCache::bytes() const {
    std::lock_guard<std::mutex> lock(_mutex);
    return _bytes;
}

} // namespace skinslide
