// A program with its own Vulkan: Terrella draws into its image, and nothing goes through the processor before this program copies the
// image out to look at it.
//
//   cc host_vulkan.c $(pkg-config --cflags --libs terrella vulkan) -lm -o host_vulkan && ./host_vulkan vulkan.png
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <terrella.h>
#include <vulkan/vulkan.h>

enum { WIDTH = 640, HEIGHT = 360 };

static void check(TerrellaStatus status) {
    if (status != TERRELLA_OK) {
        fprintf(stderr, "%s: %s\n", terrella_status_name(status), terrella_message());
        exit(1);
    }
}

static void vk(VkResult result) {
    if (result != VK_SUCCESS) {
        fprintf(stderr, "Vulkan answers %d\n", result);
        exit(1);
    }
}

static VkDeviceMemory memory(VkPhysicalDevice physical, VkDevice device, VkMemoryRequirements needed, VkMemoryPropertyFlags wanted) {
    VkPhysicalDeviceMemoryProperties types;
    vkGetPhysicalDeviceMemoryProperties(physical, &types);
    for (uint32_t i = 0; i < types.memoryTypeCount; i++) {
        if ((needed.memoryTypeBits >> i & 1) && (types.memoryTypes[i].propertyFlags & wanted) == wanted) {
            VkMemoryAllocateInfo info = {VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needed.size, .memoryTypeIndex = i};
            VkDeviceMemory got;
            vk(vkAllocateMemory(device, &info, NULL, &got));
            return got;
        }
    }
    fprintf(stderr, "no memory of that kind\n");
    exit(1);
}

int main(int argc, char **argv) {
    // The program's instance and physical device.
    VkApplicationInfo application = {VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_1};
    VkInstanceCreateInfo instance_info = {VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, .pApplicationInfo = &application};
    VkInstance instance;
    vk(vkCreateInstance(&instance_info, NULL, &instance));
    uint32_t one = 1;
    VkPhysicalDevice physical;
    VkResult found = vkEnumeratePhysicalDevices(instance, &one, &physical);
    if ((found != VK_SUCCESS && found != VK_INCOMPLETE) || one == 0) {
        fprintf(stderr, "no Vulkan device\n");
        return 1;
    }

    // Its device, with the extensions that Terrella asks for and the features that there are. Family 0 draws on every driver we know;
    // a program asks for VK_QUEUE_GRAPHICS_BIT.
    TerrellaVulkanHost host = {0};
    host.get_instance_proc_addr = (PFN_vkVoidFunction)vkGetInstanceProcAddr;
    host.instance = instance;
    host.physical_device = physical;
    host.api_version = VK_API_VERSION_1_1;
    const char *extensions[64];
    for (size_t n = 0; n < 64; n++) {
        check(terrella_vulkan_extension(&host, n, &extensions[n]));
        if (!extensions[n]) break;
        host.device_extension_count = n + 1;
    }
    VkPhysicalDeviceFeatures features;
    vkGetPhysicalDeviceFeatures(physical, &features);
    float priority = 1;
    VkDeviceQueueCreateInfo queue_info = {VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, .queueCount = 1, .pQueuePriorities = &priority};
    VkDeviceCreateInfo device_info = {VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, .queueCreateInfoCount = 1, .pQueueCreateInfos = &queue_info,
                                      .enabledExtensionCount = (uint32_t)host.device_extension_count,
                                      .ppEnabledExtensionNames = extensions, .pEnabledFeatures = &features};
    VkDevice device;
    vk(vkCreateDevice(physical, &device_info, NULL, &device));
    VkQueue queue;
    vkGetDeviceQueue(device, 0, 0, &queue);
    host.device = device;
    host.device_extensions = extensions;

    // Its image.
    VkImageCreateInfo image_info = {VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, .imageType = VK_IMAGE_TYPE_2D, .format = VK_FORMAT_R8G8B8A8_SRGB,
                                    .extent = {WIDTH, HEIGHT, 1}, .mipLevels = 1, .arrayLayers = 1, .samples = VK_SAMPLE_COUNT_1_BIT,
                                    .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT};
    VkImage image;
    vk(vkCreateImage(device, &image_info, NULL, &image));
    VkMemoryRequirements needed;
    vkGetImageMemoryRequirements(device, image, &needed);
    VkDeviceMemory image_memory = memory(physical, device, needed, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    vk(vkBindImageMemory(device, image, image_memory, 0));

    // The Earth on that device, drawn into that image.
    TerrellaOptions options;
    check(terrella_options_default(&options));
    TerrellaVulkanEarth *earth;
    check(terrella_vulkan_earth_new(&host, &options, VK_FORMAT_R8G8B8A8_SRGB, &earth));
    TerrellaTime time;
    check(terrella_time_utc("2018-06-21T16:00:00Z", &time));
    TerrellaCamera camera;
    check(terrella_camera_geodetic(13, 14, 5e6, 270, -60, 45, (double)WIDTH / HEIGHT, &camera));
    TerrellaVulkanImage target = {.image = (uint64_t)image, .width = WIDTH, .height = HEIGHT, .layout = TERRELLA_LAYOUT_TRANSFER};
    check(terrella_vulkan_draw(earth, &camera, time, 30, &target, NULL));

    // Only to look at it: the image, copied out by the same queue.
    VkBufferCreateInfo buffer_info = {VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = 4 * WIDTH * HEIGHT, .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    VkBuffer buffer;
    vk(vkCreateBuffer(device, &buffer_info, NULL, &buffer));
    vkGetBufferMemoryRequirements(device, buffer, &needed);
    VkDeviceMemory buffer_memory =
        memory(physical, device, needed, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    vk(vkBindBufferMemory(device, buffer, buffer_memory, 0));
    VkCommandPoolCreateInfo pool_info = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    VkCommandPool pool;
    vk(vkCreateCommandPool(device, &pool_info, NULL, &pool));
    VkCommandBufferAllocateInfo commands_info = {VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, .commandPool = pool, .commandBufferCount = 1};
    VkCommandBuffer commands;
    vk(vkAllocateCommandBuffers(device, &commands_info, &commands));
    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    vk(vkBeginCommandBuffer(commands, &begin));
    VkBufferImageCopy copy = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1}, .imageExtent = {WIDTH, HEIGHT, 1}};
    vkCmdCopyImageToBuffer(commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer, 1, &copy);
    vk(vkEndCommandBuffer(commands));
    VkSubmitInfo submit = {VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &commands};
    vk(vkQueueSubmit(queue, 1, &submit, VK_NULL_HANDLE));
    vk(vkQueueWaitIdle(queue));
    void *mapped;
    vk(vkMapMemory(device, buffer_memory, 0, VK_WHOLE_SIZE, 0, &mapped));
    check(terrella_write_png(argc > 1 ? argv[1] : "vulkan.png", mapped, WIDTH, HEIGHT));

    // The Earth goes before the device that it was drawn with.
    check(terrella_vulkan_earth_free(earth));
    vkDestroyCommandPool(device, pool, NULL);
    vkDestroyBuffer(device, buffer, NULL);
    vkFreeMemory(device, buffer_memory, NULL);
    vkDestroyImage(device, image, NULL);
    vkFreeMemory(device, image_memory, NULL);
    vkDestroyDevice(device, NULL);
    vkDestroyInstance(instance, NULL);
    return 0;
}
