#include "examples/adapters/dds/raw.hpp"

#include <cstring>
#include <vector>

// Fast DDS's headers are not clean under our warnings; it is a system library.
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>

#include "skinctl/core/contract.hpp"

namespace adapters::dds {

namespace fast = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
using Bytes = std::vector<unsigned char>;

namespace {

/// A type whose sample is its CDR bytes, header included. A participant has one of a name for topics of any
/// length: its size is what buffers begin with, and they grow.
class RawType : public fast::TopicDataType {
 public:
  explicit RawType(const skinctl::MessageType& type) {
    setName(type.dds_name().c_str());
    m_typeSize = 16384;
    m_isGetKeyDefined = false;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }
  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    const auto& bytes = *static_cast<const Bytes*>(data);
    if (bytes.size() > payload->max_size) return false;
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<const Bytes*>(data)->size()); };
  }
  void* createData() override { return new Bytes; }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

template <class Qos>
void set_delivery(Qos& qos, Delivery delivery) {
  qos.reliability().kind =
      delivery == Delivery::sensor ? fast::BEST_EFFORT_RELIABILITY_QOS : fast::RELIABLE_RELIABILITY_QOS;
  qos.durability().kind =
      delivery == Delivery::latched ? fast::TRANSIENT_LOCAL_DURABILITY_QOS : fast::VOLATILE_DURABILITY_QOS;
  qos.history().kind = fast::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = 1;
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.data_sharing().off();
}

}  // namespace

struct Participant::Parts {
  fast::DomainParticipant* participant = nullptr;
  fast::Publisher* publisher = nullptr;
  fast::Subscriber* subscriber = nullptr;
  ~Parts() {
    if (participant == nullptr) return;
    participant->delete_contained_entities();
    fast::DomainParticipantFactory::get_instance()->delete_participant(participant);
  }
  /// The topic, made once.
  fast::Topic* topic(const std::string& name, const skinctl::MessageType& type) {
    const std::string full = "rt" + name;
    if (auto* known = participant->lookup_topicdescription(full); known != nullptr) {
      if (known->get_type_name() != type.dds_name())
        skinctl::refuse("DDS: " + name + " already has the type " + known->get_type_name());
      return static_cast<fast::Topic*>(known);
    }
    if (participant->find_type(type.dds_name()).empty())
      fast::TypeSupport(new RawType(type)).register_type(participant);
    auto* made = participant->create_topic(full, type.dds_name(), fast::TOPIC_QOS_DEFAULT);
    if (made == nullptr) skinctl::refuse("DDS: topic " + name + " cannot be made");
    return made;
  }
};

Participant::Participant(const ParticipantOptions& options) : parts_(std::make_unique<Parts>()) {
  skinctl::require(options.domain <= 232, "DDS domain", options.domain, "0 to 232");
  if (!rtps::IPLocator::isIPv4(options.interface))
    skinctl::refuse("DDS: interface \"" + options.interface +
                    "\", allowed: an IPv4 address of this computer");
  const bool loopback = options.interface.starts_with("127.");
  fast::DomainParticipantQos qos;
  qos.name(options.name.c_str());
  const auto transport = std::make_shared<UDPv4TransportDescriptor>();
  transport->interfaceWhiteList = {options.interface};
  transport->sendBufferSize = transport->receiveBufferSize = 1 << 20;
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports = {transport};
  if (loopback) {
    // No multicast there: ask the first four participants of the domain, on their ports.
    for (std::uint32_t k = 0; k < 4; ++k) {
      rtps::Locator_t peer;
      peer.kind = LOCATOR_KIND_UDPv4;
      rtps::IPLocator::setIPv4(peer, options.interface);
      peer.port = 7410 + 250 * options.domain + 2 * k;
      qos.wire_protocol().builtin.initialPeersList.push_back(peer);
    }
  }
  qos.wire_protocol().builtin.discovery_config.leaseDuration = {10, 0};
  qos.wire_protocol().builtin.discovery_config.leaseDuration_announcementperiod = {1, 0};
  parts_->participant =
      fast::DomainParticipantFactory::get_instance()->create_participant(options.domain, qos);
  if (parts_->participant == nullptr)
    skinctl::refuse("DDS: no participant on " + options.interface + " in domain " +
                    std::to_string(options.domain));
  parts_->publisher = parts_->participant->create_publisher(fast::PUBLISHER_QOS_DEFAULT);
  parts_->subscriber = parts_->participant->create_subscriber(fast::SUBSCRIBER_QOS_DEFAULT);
  if (parts_->publisher == nullptr || parts_->subscriber == nullptr)
    skinctl::refuse("DDS: no publisher or subscriber");
}
Participant::~Participant() = default;
Participant::Participant(Participant&&) noexcept = default;

struct RawWriter::Parts {
  fast::Publisher* publisher = nullptr;
  fast::DataWriter* writer = nullptr;
  std::size_t most = 0;
  Bytes sample;
  ~Parts() {
    if (writer != nullptr) publisher->delete_datawriter(writer);
  }
};

RawWriter::RawWriter(Participant& p, const std::string& topic, const skinctl::MessageType& type,
                     Delivery delivery, std::size_t most)
    : parts_(std::make_unique<Parts>()) {
  fast::DataWriterQos qos;
  set_delivery(qos, delivery);
  qos.publish_mode().kind = fast::SYNCHRONOUS_PUBLISH_MODE;  // an asynchronous writer stalls for milliseconds
  const std::string user = "typehash=" + type.hash + ";";
  qos.user_data().setValue({user.begin(), user.end()});
  parts_->publisher = p.parts_->publisher;
  parts_->most = most;
  parts_->writer = p.parts_->publisher->create_datawriter(p.parts_->topic(topic, type), qos);
  if (parts_->writer == nullptr) skinctl::refuse("DDS: no writer of " + topic);
}
RawWriter::~RawWriter() = default;
RawWriter::RawWriter(RawWriter&&) noexcept = default;

bool RawWriter::write(std::span<const unsigned char> message) {
  if (message.size() > parts_->most) return false;
  parts_->sample.assign(message.begin(), message.end());
  return parts_->writer->write(&parts_->sample);
}
int RawWriter::readers() const {
  fast::PublicationMatchedStatus status;
  parts_->writer->get_publication_matched_status(status);
  return status.current_count;
}

struct RawReader::Parts {
  fast::Subscriber* subscriber = nullptr;
  fast::DataReader* reader = nullptr;
  std::size_t most = 0;
  Bytes sample;
  ~Parts() {
    if (reader != nullptr) subscriber->delete_datareader(reader);
  }
};

RawReader::RawReader(Participant& p, const std::string& topic, const skinctl::MessageType& type,
                     Delivery delivery, std::size_t most)
    : parts_(std::make_unique<Parts>()) {
  fast::DataReaderQos qos;
  set_delivery(qos, delivery);
  parts_->subscriber = p.parts_->subscriber;
  parts_->most = (most + 3) / 4 * 4;  // perhaps padded
  parts_->reader = p.parts_->subscriber->create_datareader(p.parts_->topic(topic, type), qos);
  if (parts_->reader == nullptr) skinctl::refuse("DDS: no reader of " + topic);
}
RawReader::~RawReader() = default;
RawReader::RawReader(RawReader&&) noexcept = default;

std::optional<std::span<const unsigned char>> RawReader::take() {
  fast::SampleInfo info;
  bool any = false;
  Bytes& sample = parts_->sample;
  while (parts_->reader->take_next_sample(&sample, &info) == ReturnCode_t::RETCODE_OK)
    if (info.valid_data) any = sample.size() <= parts_->most;
  if (!any) return std::nullopt;
  return std::span<const unsigned char>(sample);
}
bool RawReader::wait(std::chrono::milliseconds time) {
  const auto ms = time.count();
  return parts_->reader->wait_for_unread_message(
      {static_cast<std::int32_t>(ms / 1000), static_cast<std::uint32_t>(ms % 1000) * 1'000'000u});
}
int RawReader::writers() const {
  fast::SubscriptionMatchedStatus status;
  parts_->reader->get_subscription_matched_status(status);
  return status.current_count;
}

}  // namespace adapters::dds
