// The search of the theme looks for every word that begins with a word of the question: "a" would be hundreds of them.
// Here words that say nothing go, and endings of the others; site.py writes the lists where they are named.
const COMMON = new Set(/* words */);
const ENDINGS = /* endings */;
const SPELLED = [/* spelled */];

function asked(question) {
  let text = question.toLowerCase();
  for (const [from, to] of SPELLED) text = text.replace(from, to);
  const code = text.match(/\bpg\d{3}\b/);
  if (code) return code[0];
  const words = (text.match(/[\p{L}\p{N}_]+/gu) ?? []).filter((word) => !COMMON.has(word)).map((word) => {
    while (word.length > 4 && ENDINGS.test(word)) word = word.replace(ENDINGS, "");
    return word;
  });
  return words.join(" ") || question;
}

const QUERY = 2; // what the page tells its worker: 0 is the index
if (typeof Worker !== "undefined") {
  const send = Worker.prototype.postMessage;
  Worker.prototype.postMessage = function (message, ...rest) {
    return send.call(this, message?.type === QUERY ? { ...message, data: asked(message.data) } : message, ...rest);
  };
}
