(() => {
  const wide = window.innerWidth, found = [];
  const name = (node) =>
    `${node.tagName.toLowerCase()}.${node.className.baseVal ?? node.className} ${node.textContent.trim().slice(0, 60)}`;
  const scrolls = (node) => node.closest(".scroll, .picture");
  if (document.documentElement.scrollWidth > wide) found.push(`the page is ${document.documentElement.scrollWidth} wide`);
  for (const node of document.querySelectorAll("body *")) {
    const box = node.getBoundingClientRect();
    if (!box.width || !box.height || scrolls(node)) continue;
    if (box.right > wide + 1 || box.left < -1) found.push(`outside: ${name(node)}`);
    const style = getComputedStyle(node);
    if (["hidden", "clip"].includes(style.overflowX)
        && node.scrollWidth > node.clientWidth + 1 && !style.clipPath.includes("inset")) found.push(`clipped: ${name(node)}`);
  }
  for (const text of document.querySelectorAll("svg text")) {
    const rect = text.parentNode.querySelector(":scope > rect");
    if (!rect) continue;
    const a = text.getBoundingClientRect(), b = rect.getBoundingClientRect();
    if (a.width && (a.left < b.left - 1 || a.right > b.right + 1 || a.top < b.top - 1 || a.bottom > b.bottom + 1)) found.push(`out of its cell: ${text.textContent}`);
  }
  return found;
})()
