// The class for a program's own Vulkan device: it draws, moves, frees before the device, and throws.
#undef NDEBUG
#include <cassert>
#include <string>
#include <terrella.hpp>
#include <vulkan/vulkan.h>

static void vk(VkResult result) { assert(result == VK_SUCCESS); }

int main() {
    VkApplicationInfo application{};
    application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
    application.apiVersion = VK_API_VERSION_1_1;
    VkInstanceCreateInfo instance_info{};
    instance_info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
    instance_info.pApplicationInfo = &application;
    VkInstance instance;
    vk(vkCreateInstance(&instance_info, nullptr, &instance));
    std::uint32_t one = 1;
    VkPhysicalDevice physical;
    VkResult found = vkEnumeratePhysicalDevices(instance, &one, &physical);
    assert((found == VK_SUCCESS || found == VK_INCOMPLETE) && one == 1);

    TerrellaVulkanHost host{};
    host.get_instance_proc_addr = reinterpret_cast<PFN_vkVoidFunction>(vkGetInstanceProcAddr);
    host.instance = instance;
    host.physical_device = physical;
    host.api_version = VK_API_VERSION_1_1;
    auto extensions = terrella::vulkan_extensions(host);
    VkPhysicalDeviceFeatures features;
    vkGetPhysicalDeviceFeatures(physical, &features);
    float priority = 1;
    VkDeviceQueueCreateInfo queue_info{};
    queue_info.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
    queue_info.queueCount = 1;
    queue_info.pQueuePriorities = &priority;
    VkDeviceCreateInfo device_info{};
    device_info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
    device_info.queueCreateInfoCount = 1;
    device_info.pQueueCreateInfos = &queue_info;
    device_info.enabledExtensionCount = std::uint32_t(extensions.size());
    device_info.ppEnabledExtensionNames = extensions.data();
    device_info.pEnabledFeatures = &features;
    VkDevice device;
    vk(vkCreateDevice(physical, &device_info, nullptr, &device));
    host.device = device;
    host.device_extensions = extensions.data();
    host.device_extension_count = extensions.size();

    VkImageCreateInfo image_info{};
    image_info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
    image_info.imageType = VK_IMAGE_TYPE_2D;
    image_info.format = VK_FORMAT_R8G8B8A8_SRGB;
    image_info.extent = {64, 36, 1};
    image_info.mipLevels = image_info.arrayLayers = 1;
    image_info.samples = VK_SAMPLE_COUNT_1_BIT;
    image_info.usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    VkImage image;
    vk(vkCreateImage(device, &image_info, nullptr, &image));
    VkMemoryRequirements needed;
    vkGetImageMemoryRequirements(device, image, &needed);
    VkMemoryAllocateInfo memory_info{};
    memory_info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
    memory_info.allocationSize = needed.size;
    while (!(needed.memoryTypeBits >> memory_info.memoryTypeIndex & 1)) ++memory_info.memoryTypeIndex;
    VkDeviceMemory memory;
    vk(vkAllocateMemory(device, &memory_info, nullptr, &memory));
    vk(vkBindImageMemory(device, image, memory, 0));

    terrella::Time time("2018-06-21T16:00:00Z");
    auto camera = terrella::camera_geodetic(13, 14, 5e6, 270, -60, 45, 64.0 / 36.0);
    try {
        terrella::VulkanEarth(host, VK_FORMAT_D32_SFLOAT);
        assert(false);
    } catch (const terrella::Error &error) {
        assert(std::string(error.what()).find("format") != std::string::npos);
    }
    {
        terrella::VulkanEarth first(host, VK_FORMAT_R8G8B8A8_SRGB);
        auto earth = std::move(first);
        TerrellaVulkanImage target{std::uint64_t(image), 64, 36, TERRELLA_LAYOUT_TRANSFER};
        TerrellaDrawn drawn{};
        earth.draw(camera, time, target, 0, &drawn);
        assert(drawn.triangles > 0);
        VkQueue queue;
        vkGetDeviceQueue(device, 0, 0, &queue);
        vk(vkQueueWaitIdle(queue));
        target.width = 0;
        try {
            earth.draw(camera, time, target);
            assert(false);
        } catch (const terrella::Error &error) {
            assert(error.status() == TERRELLA_ARGUMENT);
        }
    }
    vkDestroyImage(device, image, nullptr);
    vkFreeMemory(device, memory, nullptr);
    vkDestroyDevice(device, nullptr);
    vkDestroyInstance(instance, nullptr);
}
